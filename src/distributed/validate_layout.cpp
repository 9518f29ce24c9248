// Whether a mesh can be looked at at all: sizes, ranges, coordinates, order.
#include "validation.hpp"

#include "dovetail/geometry/predicates.hpp"
#include "dovetail/mesh/validate.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <optional>

namespace dovetail::validation {
namespace {

/// Order-dependent hash, for finding out whether all ranks hold the same.
class Hash {
public:
  void add(std::uint64_t word) {
    word += 0x9e3779b97f4a7c15U + (value_ << 6) + (value_ >> 2);
    value_ = (value_ ^ word) * 0x94d049bb133111ebU;
  }
  void add(const std::string &text) {
    add(text.size());
    for (const char c : text)
      add(static_cast<std::uint64_t>(c));
  }
  void add(const std::vector<GlobalIndex> &values) {
    add(values.size());
    for (const GlobalIndex value : values)
      add(static_cast<std::uint64_t>(value));
  }
  std::uint64_t value() const { return value_; }

private:
  std::uint64_t value_ = 0;
};

/// Of what must be the same on all ranks.
std::uint64_t hash_of_common(const DistributedMesh &mesh) {
  Hash hash;
  hash.add(static_cast<std::uint64_t>(mesh.axis));
  hash.add(mesh.site_offsets);
  hash.add(mesh.triangle_offsets);
  hash.add(mesh.lines.size());
  for (const double line : mesh.lines)
    hash.add(std::bit_cast<std::uint64_t>(line));
  hash.add(static_cast<std::uint64_t>(mesh.hull_edges));
  hash.add(mesh.checksum);
  hash.add(static_cast<std::uint64_t>(mesh.digest.points));
  hash.add(mesh.digest.hash);
  return hash.value();
}

std::uint64_t hash_of_names(const SlabMesh &slab) {
  Hash hash;
  for (const Attribute &attribute : slab.vertices.attributes)
    hash.add(attribute.name);
  return hash.value();
}

bool are_offsets(const std::vector<GlobalIndex> &offsets) {
  return !offsets.empty() && offsets.front() == 0 && std::is_sorted(offsets.begin(), offsets.end());
}

/// Local: what is wrong with the arrays that all ranks hold, or an empty text.
std::string fault_of_common(const DistributedMesh &mesh) {
  if (!are_offsets(mesh.site_offsets) || !are_offsets(mesh.triangle_offsets))
    return "site or triangle offsets do not ascend from 0";
  if (mesh.site_offsets.size() != mesh.triangle_offsets.size())
    return "there are site offsets for another number of slabs than triangle offsets";
  if (mesh.lines.size() != at(std::max(0, mesh.slab_count() - 1)))
    return fmt::format("{} lines for {} slabs", mesh.lines.size(), mesh.slab_count());
  return {};
}

/// Local: what is wrong with the arrays of own slab k, or an empty text.
std::string fault_of_slab(const DistributedMesh &mesh, const SlabMesh &slab, std::size_t s) {
  const PointTable &table = slab.vertices;
  const auto vertices = static_cast<GlobalIndex>(table.points.size());
  const GlobalIndex own = mesh.site_offsets[s + 1] - mesh.site_offsets[s];
  if (slab.first_site != mesh.site_offsets[s] || slab.own_count != own || own > vertices)
    return fmt::format("has sites {} to {} where the offsets say {} to {}", slab.first_site,
                       slab.first_site + slab.own_count, mesh.site_offsets[s], mesh.site_offsets[s + 1]);
  if (table.input_index.size() != table.points.size() ||
      std::ranges::any_of(table.attributes, [&](const Attribute &column) {
        return column.values.size() != table.points.size();
      }))
    return "has columns of different lengths";
  if (slab.ghost_number.size() != at(vertices - own))
    return fmt::format("has {} ghosts and {} numbers for them", vertices - own, slab.ghost_number.size());
  GlobalIndex before = none;
  for (const GlobalIndex number : slab.ghost_number) {
    if (number <= before || number >= mesh.site_count() ||
        (number >= slab.first_site && number < slab.first_site + slab.own_count))
      return fmt::format("has a ghost numbered {}, which is out of order or range", number);
    before = number;
  }
  const Triangulation &triangles = slab.triangles;
  const GlobalIndex end = mesh.triangle_offsets[s + 1];
  if (!layout_is_sound(table.points.size(), triangles))
    return "has a corner or neighbour that is out of range";
  if (slab.first_triangle != mesh.triangle_offsets[s] ||
      triangles.triangle_count() != end - slab.first_triangle)
    return fmt::format("has triangles {} to {} where the offsets say {} to {}", slab.first_triangle,
                       slab.first_triangle + triangles.triangle_count(), mesh.triangle_offsets[s], end);
  LocalIndex last = -1;
  for (const BorderSide &border : slab.border_sides) {
    if (border.side <= last || at(border.side) >= triangles.neighbours.size() ||
        triangles.neighbours[at(border.side)] != none)
      return fmt::format("has border side {} out of order or range, or with a neighbour inside", border.side);
    last = border.side;
    if (border.neighbour < 0 || border.neighbour >= mesh.triangle_count() ||
        (border.neighbour >= slab.first_triangle && border.neighbour < end))
      return fmt::format("has triangle {} as neighbour across its border", border.neighbour);
  }
  for (const GlobalIndex site : slab.left_path)
    if (site < 0 || site >= mesh.site_count())
      return fmt::format("has site {} on its left path", site);
  if (s == 0 && !slab.left_path.empty())
    return "has a left path, and nothing on its left";
  return {};
}

} // namespace

std::vector<int> check_common(const Communicator &comm, const SlabSource &source, Findings &findings) {
  const DistributedMesh &common = source.common();
  const auto complain = [&](std::string text) {
    findings.add(ViolationKind::layout, [&] { return std::move(text); });
  };
  const std::uint64_t hash = hash_of_common(common);
  const bool differ = all_reduce_min(comm, hash) != all_reduce_max(comm, hash);
  std::vector<int> firsts = all_gather(comm, common.first_slab);
  const std::vector<int> counts = all_gather(comm, source.own_slab_count());
  if (differ && comm.is_root())
    complain("what all ranks should share differs between them");
  if (std::string fault = fault_of_common(common); !fault.empty()) {
    complain(std::move(fault));
  } else {
    int next = 0;
    for (std::size_t rank = 0; rank < firsts.size(); ++rank) {
      if (comm.is_root() && firsts[rank] != next)
        complain(
            fmt::format("rank {} begins with slab {} where slab {} comes next", rank, firsts[rank], next));
      next = firsts[rank] + counts[rank];
    }
    if (comm.is_root() && next != common.slab_count())
      complain(fmt::format("the ranks end with slab {} of {}", next, common.slab_count()));
  }
  if (any_of_ranks(comm, findings.any()))
    return {};
  firsts.push_back(common.slab_count());
  return firsts;
}

namespace {

/// Local: whether all coordinates are finite; no predicate may see them otherwise.
bool check_coordinates(const SlabMesh &slab, std::size_t s, Findings &findings) {
  bool finite = true;
  for (std::size_t v = 0; v < slab.vertices.points.size(); ++v) {
    const Point p = slab.vertices.points[v];
    const bool is_finite = std::isfinite(p.x) && std::isfinite(p.y);
    const bool is_canonical = !(p.x == 0 && std::signbit(p.x)) && !(p.y == 0 && std::signbit(p.y));
    finite = finite && is_finite;
    if (!is_finite || !is_canonical)
      findings.add(ViolationKind::coordinate, [&] {
        return fmt::format("slab {}, site {}: {} is {}", s, number_of(slab, static_cast<LocalIndex>(v)),
                           text_of(p), is_finite ? "a negative zero" : "not finite");
      });
  }
  return finite;
}

} // namespace

bool gather_layout(const DistributedMesh &common, const SlabMesh &slab, std::size_t s, Gathered &gathered,
                   Findings &findings) {
  gathered.attribute_names.push_back(hash_of_names(slab));
  if (const std::string fault = fault_of_slab(common, slab, s); !fault.empty()) {
    findings.add(ViolationKind::layout, [&] { return fmt::format("slab {} {}", s, fault); });
    gathered.is_sound = false;
    return false;
  }
  findings.counts.sites += slab.own_count;
  findings.counts.ghosts += static_cast<GlobalIndex>(slab.ghost_number.size());
  findings.counts.triangles += slab.triangles.triangle_count();
  gathered.left_paths.push_back(slab.left_path);
  const bool finite = check_coordinates(slab, s, findings);
  gathered.is_finite = gathered.is_finite && finite;
  return finite;
}

bool check_soundness(const Communicator &comm, const DistributedMesh &common, const Gathered &gathered,
                     Findings &findings) {
  std::uint64_t lowest = ~std::uint64_t{0};
  for (const std::uint64_t names : gathered.attribute_names)
    lowest = std::min(lowest, names);
  lowest = all_reduce_min(comm, lowest);
  bool alike = true;
  for (std::size_t k = 0; k < gathered.attribute_names.size(); ++k)
    if (gathered.attribute_names[k] != lowest) {
      alike = false;
      findings.add(ViolationKind::layout, [&] {
        return fmt::format("slab {} has other attributes than others", at(common.first_slab) + k);
      });
    }
  if (!all_of_ranks(comm, gathered.is_sound && alike))
    findings.keep_only({ViolationKind::layout});
  else if (!all_of_ranks(comm, gathered.is_finite))
    findings.keep_only({ViolationKind::layout, ViolationKind::coordinate});
  else
    return true;
  return false;
}

namespace {

/// The lines that have one of the slab's own sites just before or just behind them.
void check_lines(const DistributedMesh &mesh, const SlabMesh &slab, Findings &findings) {
  const std::vector<GlobalIndex> &offsets = mesh.site_offsets;
  const GlobalIndex end = slab.first_site + slab.own_count;
  for (auto offset = std::lower_bound(offsets.begin() + 1, offsets.end() - 1, slab.first_site);
       offset < offsets.end() - 1 && *offset <= end; ++offset) {
    const std::ptrdiff_t s = offset - offsets.begin();
    const double line = mesh.lines[at(s - 1)];
    const auto check = [&](GlobalIndex site, bool is_before) {
      if (site < slab.first_site || site >= end)
        return;
      const double position = across(slab.vertices.points[at(site - slab.first_site)], mesh.axis);
      if (!std::isfinite(line) || !(is_before ? position <= line : line <= position))
        findings.add(ViolationKind::line, [&] {
          return fmt::format("the line left of slab {} is at {:.17g}, and site {} {} it at {:.17g}", s, line,
                             site, is_before ? "before" : "behind", position);
        });
    };
    check(*offset - 1, true);
    check(*offset, false);
  }
}

} // namespace

namespace {

void check_ascent(const DistributedMesh &common, Point before, const SiteAt &site, Findings &findings) {
  if (!TotalOrder{common.axis}(before, site.point))
    findings.add(ViolationKind::order, [&] {
      return fmt::format("site {} {} does not come after site {} {}", site.number, text_of(site.point),
                         site.number - 1, text_of(before));
    });
}

} // namespace

void gather_order(const DistributedMesh &common, const SlabMesh &slab, Gathered &gathered,
                  Findings &findings) {
  for (LocalIndex v = 0; v < slab.own_count; ++v) {
    const SiteAt site{slab.first_site + v, point_of(slab, v)};
    if (gathered.last_site)
      check_ascent(common, gathered.last_site->point, site, findings);
    else
      gathered.first_site = site;
    gathered.last_site = site;
  }
  check_lines(common, slab, findings);
  gathered.slab_ends.push_back(
      slab.own_count > 0 ? SlabEnds{point_of(slab, 0), point_of(slab, slab.own_count - 1), slab.own_count}
                         : SlabEnds{{0, 0}, {0, 0}, 0});
}

void check_order_across_ranks(const Communicator &comm, const DistributedMesh &common,
                              const Gathered &gathered, Findings &findings) {
  struct Last {
    Point point;
    std::int64_t any;
  };
  const auto all =
      all_gather(comm, gathered.last_site ? Last{gathered.last_site->point, 1} : Last{{0, 0}, 0});
  for (int rank = comm.rank() - 1; rank >= 0 && gathered.first_site; --rank)
    if (all[at(rank)].any != 0) {
      check_ascent(common, all[at(rank)].point, *gathered.first_site, findings);
      break;
    }
}

namespace {

/// Local: all own sites of a slab are between the first and the last site of all.
void check_on_line(const DistributedMesh &common, const PointTable &vertices, std::size_t s, Point first,
                   Point last, Findings &findings) {
  for (GlobalIndex v = common.site_offsets[s]; v < common.site_offsets[s + 1]; ++v) {
    const Point p = vertices.points[at(v - common.site_offsets[s])];
    if (exact::orientation(first, last, p) != Sign::zero)
      findings.add(ViolationKind::collinear, [&] {
        return fmt::format("there are no triangles, but site {} {} is not on the line of sites 0 and {}", v,
                           text_of(p), common.site_count() - 1);
      });
  }
}

/// Of collinear sites in a row across the lines, which is nearest to the line left of slab s: the one before
/// it or the one behind it.
GlobalIndex nearest_in_row(const DistributedMesh &common, const std::vector<SlabEnds> &ends, std::size_t s) {
  const auto line = static_cast<std::ptrdiff_t>(s);
  const auto has_sites = [](const SlabEnds &slab) { return slab.count > 0; };
  const auto behind = std::find_if(ends.begin() + line, ends.end(), has_sites);
  const auto before = std::find_if(ends.rend() - line, ends.rend(), has_sites);
  const GlobalIndex border = common.site_offsets[s];
  if (before == ends.rend() || behind == ends.end())
    return before == ends.rend() ? border : border - 1;
  return exact::nearer(behind->first, before->last, {common.lines[s - 1], common.axis}) ? border : border - 1;
}

/// Local. Sites on a line parallel to the cuts' normal have one-site paths, the nearest to each line; of all
/// others every split line meets every cell.
void check_path_on_line(const DistributedMesh &common, const std::vector<SlabEnds> &ends, std::size_t s,
                        Point first, Point last, const std::vector<GlobalIndex> &path, Findings &findings) {
  const bool single = along(first, common.axis) == along(last, common.axis);
  const bool descending = along(first, common.axis) > along(last, common.axis);
  std::vector<GlobalIndex> expected(at(single ? 1 : common.site_count()));
  std::iota(expected.begin(), expected.end(), single ? nearest_in_row(common, ends, s) : 0);
  if (descending)
    std::reverse(expected.begin(), expected.end());
  if (path != expected)
    findings.add(ViolationKind::path, [&] {
      return fmt::format("slab {}: the path of collinear sites has {} sites where {} must be, or others", s,
                         path.size(), expected.size());
    });
  findings.counts.path_edges += static_cast<GlobalIndex>(expected.size()) - 1;
}

} // namespace

void check_collinear(const Communicator &comm, SlabSource &source, const Gathered &gathered,
                     Findings &findings) {
  const DistributedMesh &common = source.common();
  if (common.hull_edges != 0 && comm.is_root())
    findings.add(ViolationKind::hull,
                 [&] { return fmt::format("{} hull edges of no triangles", common.hull_edges); });
  if (common.site_count() == 0)
    return;
  const std::vector<SlabEnds> ends = all_gather_bulk<SlabEnds>(comm, gathered.slab_ends).data;
  const auto has_sites = [](const SlabEnds &slab) { return slab.count > 0; };
  const Point first = std::ranges::find_if(ends, has_sites)->first;
  const Point last = std::find_if(ends.rbegin(), ends.rend(), has_sites)->last;
  collectively(comm, checking_text, [&] {
    for (int k = 0; k < source.own_slab_count(); ++k) {
      const std::size_t s = at(common.first_slab + k);
      check_on_line(common, source.vertices(k), s, first, last, findings);
      if (s > 0)
        check_path_on_line(common, ends, s, first, last, gathered.left_paths[at(k)], findings);
    }
  });
}

} // namespace dovetail::validation
