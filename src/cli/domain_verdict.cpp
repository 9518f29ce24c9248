#include "domain_verdict.hpp"

#include "domain_job.hpp"
#include "text.hpp"

#include "dovetail/geometry/predicates.hpp"
#include "dovetail/io/domain.hpp"
#include "dovetail/mesh/checksum.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <unordered_set>

namespace dovetail::cli {
namespace {

constexpr std::size_t most_told = 20;

template <class Index> std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Faults in words; those beyond the first few are only counted.
class Faults {
public:
  template <class MakeText> void add(MakeText &&text) {
    if (++count_ <= most_told)
      texts_.push_back(text());
  }
  void move_into(std::vector<std::string> &texts) {
    if (count_ > most_told)
      texts_.push_back(fmt::format("and {} more", count_ - most_told));
    texts.insert(texts.end(), texts_.begin(), texts_.end());
  }

private:
  std::size_t count_ = 0;
  std::vector<std::string> texts_;
};

/// The mesh by itself; triangles that it says were left below the bound are none of its faults.
void check_mesh(const DistributedMesh &mesh, DomainVerdict &verdict) {
  const DomainRecord &record = record_of(mesh);
  verdict.found = validate_domain(domain_of_slab(mesh), record.segments, record.min_angle,
                                  most_told + record.left_triangles.size());
  const std::unordered_set<LocalIndex> left(record.left_triangles.begin(), record.left_triangles.end());
  Faults faults;
  GlobalIndex told = 0;
  for (const DomainFault &fault : verdict.found.first_faults) {
    ++told;
    if (fault.kind == DomainFaultKind::angle && left.contains(fault.triangle))
      ++verdict.left_triangles;
    else
      faults.add([&] { return fmt::format("{}: {}", name_of(fault.kind), fault.text); });
  }
  if (const GlobalIndex rest = verdict.found.fault_count - told; rest > 0)
    faults.add([&] { return fmt::format("and {} more faults", rest); });
  faults.move_into(verdict.faults);
}

/// What the slab says of itself.
void check_slab(const DistributedMesh &mesh, DomainVerdict &verdict) {
  const SlabMesh &slab = mesh.slabs.front();
  const auto &points = slab.vertices.points;
  for (std::size_t v = 1; v < points.size(); ++v)
    if (!lexicographically_less(points[v - 1], points[v])) {
      verdict.faults.push_back(fmt::format("order: site {} does not come after the one before it", v));
      break;
    }
  if (mesh.checksum != checksum_of_sites(points) + checksum_of_triangles(points, slab.triangles.corners))
    verdict.faults.push_back("checksum: is not that of sites and triangles");
  if (mesh.hull_edges != std::ranges::count(slab.triangles.neighbours, none))
    verdict.faults.push_back("boundary: hull_edges does not count the sides without neighbour");
}

/// Every link of a chain is a segment of the graph, and every segment of the graph a link.
void check_chains(const DistributedMesh &mesh, DomainVerdict &verdict) {
  const DomainRecord &record = record_of(mesh);
  const auto graph_segments = std::ssize(record.segments) - record.hull_segments;
  std::set<std::pair<LocalIndex, LocalIndex>> segments;
  for (std::ptrdiff_t s = 0; s < graph_segments; ++s)
    segments.insert(std::minmax(record.segments[at(s)].from, record.segments[at(s)].to));
  std::set<std::pair<LocalIndex, LocalIndex>> links;
  Faults faults;
  for (std::size_t c = 1; c < record.chain_offsets.size(); ++c) {
    for (auto k = record.chain_offsets[c - 1] + 1; k < record.chain_offsets[c]; ++k) {
      const std::pair<LocalIndex, LocalIndex> link =
          std::minmax(record.chain_vertices[at(k) - 1], record.chain_vertices[at(k)]);
      links.insert(link);
      if (!segments.contains(link))
        faults.add([&] {
          return fmt::format("chain: segment {} given goes from site {} to {}, which no segment joins", c - 1,
                             link.first, link.second);
        });
    }
    ++verdict.chains;
  }
  if (links.size() != segments.size() && verdict.chains > 0)
    faults.add([&] {
      return fmt::format("chain: {} segments are in no chain of a segment given",
                         segments.size() - links.size());
    });
  faults.move_into(verdict.faults);
}

/// A piece's vertices inside a segment have its marker, unless they were given.
void check_markers(const DistributedMesh &mesh, DomainVerdict &verdict) {
  const DomainMesh domain = domain_of_slab(mesh);
  const DomainRecord &record = record_of(mesh);
  const SlabMesh &slab = mesh.slabs.front();
  std::vector<std::uint8_t> is_end(domain.vertices.size(), 0);
  for (const Segment &segment : record.segments)
    is_end[at(segment.from)] = is_end[at(segment.to)] = 1;
  Faults faults;
  for (std::size_t side = 0; side < domain.segment_of_side.size(); ++side) {
    const LocalIndex s = domain.segment_of_side[side];
    if (s < 0 || at(s) >= record.segments.size())
      continue;
    const std::size_t base = side - side % 3;
    for (const std::size_t corner : {(side + 1) % 3, (side + 2) % 3}) {
      const LocalIndex v = slab.triangles.corners[base + corner];
      if (is_end[at(v)] == 0 && domain.vertex_markers[at(v)] != record.segments[at(s)].marker)
        faults.add([&] {
          return fmt::format("marker: site {} has {} on segment {} with {}", v, domain.vertex_markers[at(v)],
                             s, record.segments[at(s)].marker);
        });
    }
  }
  faults.move_into(verdict.faults);
}

/// Whether the chain of vertices, from a to b, stays within a few roundings of the segment.
bool stays_near(const std::vector<Point> &points, std::span<const LocalIndex> chain, Point a, Point b) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  const double size = std::max({std::fabs(a.x), std::fabs(a.y), std::fabs(b.x), std::fabs(b.y)});
  for (const LocalIndex v : chain) {
    const Point p = points[at(v)];
    if (p.x < std::min(a.x, b.x) || p.x > std::max(a.x, b.x) || p.y < std::min(a.y, b.y) ||
        p.y > std::max(a.y, b.y))
      return false;
    if (std::fabs(dx * (p.y - a.y) - dy * (p.x - a.x)) > 0x1p-47 * size * (std::fabs(dx) + std::fabs(dy)))
      return false;
  }
  return true;
}

/// Vertices and segments given, one by one; nothing is brought in order again.
void compare(const DistributedMesh &mesh, const DomainFile &file, DomainVerdict &verdict) {
  const DomainRecord &record = record_of(mesh);
  const SlabMesh &slab = mesh.slabs.front();
  Faults faults;
  if (record.given_vertices != std::ssize(file.set.vertices) ||
      std::ssize(record.chain_offsets) - 1 != std::ssize(file.set.segments)) {
    faults.add([&] {
      return fmt::format("domain: the file has {} vertices and {} segments, and the mesh is of {} and {}",
                         file.set.vertices.size(), file.set.segments.size(), record.given_vertices,
                         record.chain_offsets.size() - 1);
    });
    faults.move_into(verdict.faults);
    return;
  }
  std::vector<LocalIndex> vertex_of(file.set.vertices.size(), none);
  for (std::size_t v = 0; v < slab.vertices.input_index.size(); ++v)
    if (const GlobalIndex number = slab.vertices.input_index[v];
        number < record.given_vertices && number >= 0)
      vertex_of[at(number)] = static_cast<LocalIndex>(v);
  for (const Duplicate &duplicate : mesh.duplicates)
    if (duplicate.input_index >= 0 && duplicate.input_index < record.given_vertices && duplicate.site >= 0 &&
        duplicate.site < slab.own_count)
      vertex_of[at(duplicate.input_index)] = static_cast<LocalIndex>(duplicate.site);
  for (std::size_t i = 0; i < vertex_of.size(); ++i)
    if (vertex_of[i] == none || !(slab.vertices.points[at(vertex_of[i])] == file.set.vertices[i]))
      faults.add([&] {
        return fmt::format("domain: vertex {} ({}, {}) is not where the mesh has it",
                           static_cast<std::size_t>(file.first_number) + i, file.set.vertices[i].x,
                           file.set.vertices[i].y);
      });
  for (std::size_t s = 0; s < file.set.segments.size(); ++s) {
    const Segment &segment = file.set.segments[s];
    const auto first = at(record.chain_offsets[s]), last = at(record.chain_offsets[s + 1]);
    const std::span chain(record.chain_vertices.data() + first, last - first);
    if (chain.empty() || chain.front() != vertex_of[at(segment.from)] ||
        chain.back() != vertex_of[at(segment.to)] ||
        !stays_near(slab.vertices.points, chain, file.set.vertices[at(segment.from)],
                    file.set.vertices[at(segment.to)]))
      faults.add([&] {
        return fmt::format("domain: {} is not the chain that the mesh has for it",
                           name_of_segment(file, static_cast<LocalIndex>(s)));
      });
  }
  const auto same_seed = [](const RegionSeed &a, const RegionSeed &b) {
    return a.place == b.place && a.attribute == b.attribute && a.max_area == b.max_area;
  };
  if (record.holes != file.set.holes || !std::ranges::equal(record.regions, file.set.regions, same_seed))
    faults.add([] { return "domain: the mesh has other holes or regions than the file"; });
  verdict.compared = std::ssize(file.set.vertices) + std::ssize(file.set.segments);
  faults.move_into(verdict.faults);
}

} // namespace

DomainVerdict verify_domain(const DistributedMesh &mesh, const std::string &domain_file) {
  DomainVerdict verdict;
  check_mesh(mesh, verdict);
  check_slab(mesh, verdict);
  if (verdict.found.count(DomainFaultKind::layout) == 0) {
    check_chains(mesh, verdict);
    check_markers(mesh, verdict);
  }
  if (!domain_file.empty()) {
    const bool valid = verdict.valid();
    compare(mesh, read_domain(domain_file), verdict);
    verdict.only_the_domain_differs = valid && !verdict.valid();
  }
  return verdict;
}

void print_verdict(const DistributedMesh &mesh, const DomainVerdict &verdict) {
  const auto row = [](const char *what, GlobalIndex number, const std::string &how) {
    print_row(what, fmt::format("{}: {}", with_separators(number), how));
  };
  const DomainReport &found = verdict.found;
  row("triangles", mesh.triangle_count(), "counter-clockwise, neighbours agree");
  row("inner edges", found.inner_edges, "locally Delaunay, or pieces of segments");
  row("segments", std::ssize(record_of(mesh).segments),
      fmt::format("one chain of edges each, {} edges together, {} of them outside of the domain",
                  with_separators(found.pieces), with_separators(found.missing_segments)));
  if (verdict.chains > 0)
    row("segments given", verdict.chains, "chains of segments");
  row("boundary edges", found.boundary_edges,
      fmt::format("all of segments, {} in {}", counted(found.boundaries, "closed curve", "closed curves"),
                  counted(found.components, "component", "components")));
  print_row("area", fmt::format("{:.9g}, that of the domain", found.area));
  if (record_of(mesh).min_angle > 0)
    print_row("smallest angle",
              fmt::format("{:.4f}; below {:g} {} between small input angles, and {} left by limits",
                          found.smallest_angle, record_of(mesh).min_angle,
                          counted(found.exempt_triangles, "triangle", "triangles"),
                          with_separators(verdict.left_triangles)));
  else
    print_row("smallest angle", fmt::format("{:.4f}, not refined", found.smallest_angle));
  if (verdict.compared > 0)
    row("domain", verdict.compared, "vertices and segments of the file, all there");
  print_row("checksum", checksum_text(mesh.checksum));
}

void report_verdict(const DistributedMesh &mesh, const DomainVerdict &verdict, Report &report) {
  const DomainReport &found = verdict.found;
  report_domain(mesh, report);
  report["valid"] = verdict.valid();
  report["inner_edges"] = found.inner_edges;
  report["pieces"] = found.pieces;
  report["components"] = found.components;
  report["boundaries"] = found.boundaries;
  report["pinched"] = found.pinched;
  report["segments_outside"] = found.missing_segments;
  report["chains"] = verdict.chains;
  report["area"] = found.area;
  report["bend"] = found.bend;
  report["min_angle"] = record_of(mesh).min_angle;
  report["smallest_angle"] = found.smallest_angle;
  report["exempt_triangles"] = found.exempt_triangles;
  report["left_triangles"] = verdict.left_triangles;
  report["domain_compared"] = verdict.compared;
  report["violations"] = std::ssize(verdict.faults);
  report["first_violations"] = verdict.faults;
}

} // namespace dovetail::cli
