// Whether a mesh can be looked at at all: sizes, ranges, coordinates, order.
#include "validation.hpp"

#include "dovetail/geometry/predicates.hpp"
#include "dovetail/mesh/validate.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <limits>
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

std::vector<int> check_layout(const Communicator &comm, const DistributedMesh &mesh, Findings &findings) {
  const auto complain = [&](std::string text) {
    findings.add(ViolationKind::layout, [&] { return std::move(text); });
  };
  const std::uint64_t common = hash_of_common(mesh);
  const bool differ = all_reduce_min(comm, common) != all_reduce_max(comm, common);
  std::vector<int> firsts = all_gather(comm, mesh.first_slab);
  const std::vector<int> counts = all_gather(comm, static_cast<int>(mesh.slabs.size()));
  const bool has_slabs = !mesh.slabs.empty();
  const std::uint64_t names = has_slabs ? hash_of_names(mesh.slabs.front()) : 0;
  const std::uint64_t lowest_names = all_reduce_min(comm, has_slabs ? names : ~std::uint64_t{0});

  if (differ && comm.is_root())
    complain("what all ranks should share differs between them");
  if (std::string common_fault = fault_of_common(mesh); !common_fault.empty()) {
    complain(std::move(common_fault));
  } else {
    int next = 0;
    for (std::size_t rank = 0; rank < firsts.size(); ++rank) {
      if (comm.is_root() && firsts[rank] != next)
        complain(
            fmt::format("rank {} begins with slab {} where slab {} comes next", rank, firsts[rank], next));
      next = firsts[rank] + counts[rank];
    }
    if (comm.is_root() && next != mesh.slab_count())
      complain(fmt::format("the ranks end with slab {} of {}", next, mesh.slab_count()));
    for (std::size_t k = 0; k < mesh.slabs.size() && at(mesh.first_slab) + k < at(mesh.slab_count()); ++k) {
      const std::size_t s = at(mesh.first_slab) + k;
      if (std::string fault = fault_of_slab(mesh, mesh.slabs[k], s); !fault.empty())
        complain(fmt::format("slab {} {}", s, fault));
      if (hash_of_names(mesh.slabs[k]) != lowest_names)
        complain(fmt::format("slab {} has other attributes than others", s));
    }
  }
  if (any_of_ranks(comm, findings.any()))
    return {};
  firsts.push_back(mesh.slab_count());
  return firsts;
}

bool check_coordinates(const Communicator &comm, const DistributedMesh &mesh, Findings &findings) {
  bool finite = true;
  int s = mesh.first_slab;
  for (const SlabMesh &slab : mesh.slabs) {
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
    findings.counts.sites += slab.own_count;
    findings.counts.ghosts += static_cast<GlobalIndex>(slab.ghost_number.size());
    findings.counts.triangles += slab.triangles.triangle_count();
    ++s;
  }
  return all_of_ranks(comm, finite);
}

namespace {

/// The lines whose last site before them the slab owns.
void check_lines(const DistributedMesh &mesh, const SlabMesh &slab, Findings &findings) {
  const std::vector<GlobalIndex> &offsets = mesh.site_offsets;
  if (slab.own_count == 0)
    return;
  // Before a line that follows no site, the first site of all counts.
  const GlobalIndex lowest = slab.first_site == 0 ? 0 : slab.first_site + 1;
  for (auto offset = std::lower_bound(offsets.begin() + 1, offsets.end() - 1, lowest);
       offset < offsets.end() - 1 && *offset <= slab.first_site + slab.own_count; ++offset) {
    const GlobalIndex before = std::max<GlobalIndex>(*offset - 1, 0);
    const std::ptrdiff_t line = offset - offsets.begin() - 1;
    const double expected = across(slab.vertices.points[at(before - slab.first_site)], mesh.axis);
    if (!(mesh.lines[at(line)] == expected))
      findings.add(ViolationKind::line, [&] {
        return fmt::format("the line left of slab {} is at {:.17g}, and site {} before it at {:.17g}",
                           line + 1, mesh.lines[at(line)], before, expected);
      });
  }
}

} // namespace

void check_order_and_lines(const Communicator &comm, const DistributedMesh &mesh, Findings &findings) {
  const TotalOrder less{mesh.axis};
  std::optional<Point> last;
  std::optional<Point> first;
  const auto check = [&](Point before, Point p, GlobalIndex number) {
    if (!less(before, p))
      findings.add(ViolationKind::order, [&] {
        return fmt::format("site {} {} does not come after site {} {}", number, text_of(p), number - 1,
                           text_of(before));
      });
  };
  for (const SlabMesh &slab : mesh.slabs) {
    for (LocalIndex v = 0; v < slab.own_count; ++v) {
      const Point p = point_of(slab, v);
      if (last)
        check(*last, p, slab.first_site + v);
      else
        first = p;
      last = p;
    }
    check_lines(mesh, slab, findings);
  }
  struct Ends {
    Point first, last;
    std::int64_t any;
  };
  const auto all = all_gather(
      comm, Ends{first.value_or(Point{0, 0}), last.value_or(Point{0, 0}), first.has_value() ? 1 : 0});
  for (int rank = comm.rank() - 1; rank >= 0 && first; --rank)
    if (all[at(rank)].any != 0) {
      const auto owner = std::ranges::find_if(mesh.slabs, [](const SlabMesh &s) { return s.own_count > 0; });
      check(all[at(rank)].last, *first, owner->first_site);
      break;
    }
}

namespace {

/// Local: all sites are between the first and the last site of all, and on all paths that must have them.
void check_on_line(const DistributedMesh &mesh, Point first, Point last, Findings &findings) {
  // Sites on a line parallel to the cuts' normal have one-site paths, the nearest to each line; of all others
  // every split line meets every cell.
  const bool single = along(first, mesh.axis) == along(last, mesh.axis);
  const bool descending = along(first, mesh.axis) > along(last, mesh.axis);
  int s = mesh.first_slab;
  for (const SlabMesh &slab : mesh.slabs) {
    for (LocalIndex v = 0; v < slab.own_count; ++v)
      if (exact::orientation(first, last, point_of(slab, v)) != Sign::zero)
        findings.add(ViolationKind::collinear, [&] {
          return fmt::format("there are no triangles, but site {} {} is not on the line of sites 0 and {}",
                             slab.first_site + v, text_of(point_of(slab, v)), mesh.site_count() - 1);
        });
    std::vector<GlobalIndex> expected(at(single ? 1 : mesh.site_count()));
    std::iota(expected.begin(), expected.end(), single ? std::max<GlobalIndex>(slab.first_site - 1, 0) : 0);
    if (descending)
      std::reverse(expected.begin(), expected.end());
    if (s > 0 && slab.left_path != expected)
      findings.add(ViolationKind::path, [&] {
        return fmt::format("slab {}: the path of collinear sites has {} sites where {} must be, or others", s,
                           slab.left_path.size(), expected.size());
      });
    if (s > 0)
      findings.counts.path_edges += static_cast<GlobalIndex>(expected.size()) - 1;
    ++s;
  }
}

} // namespace

void check_collinear(const Communicator &comm, const DistributedMesh &mesh, Findings &findings) {
  if (mesh.hull_edges != 0 && comm.is_root())
    findings.add(ViolationKind::hull,
                 [&] { return fmt::format("{} hull edges of no triangles", mesh.hull_edges); });
  if (mesh.site_count() == 0)
    return;
  // The first and the last site of all.
  std::vector<double> ends(4, -std::numeric_limits<double>::infinity());
  for (const SlabMesh &slab : mesh.slabs) {
    if (slab.own_count > 0 && slab.first_site == 0) {
      ends[0] = point_of(slab, 0).x;
      ends[1] = point_of(slab, 0).y;
    }
    if (slab.own_count > 0 && slab.first_site + slab.own_count == mesh.site_count()) {
      ends[2] = point_of(slab, slab.own_count - 1).x;
      ends[3] = point_of(slab, slab.own_count - 1).y;
    }
  }
  ends = all_reduce_max(comm, ends);
  const Point first{ends[0], ends[1]};
  const Point last{ends[2], ends[3]};
  collectively(comm, checking_text, [&] { check_on_line(mesh, first, last, findings); });
}

} // namespace dovetail::validation
