// Triangles and the edges between them: inside a slab, across borders, and on the hull.
#include "validation.hpp"

#include "dovetail/geometry/predicates.hpp"
#include "dovetail/mesh/validate.hpp"

#include <fmt/format.h>

#include <tuple>

namespace dovetail::validation {
namespace {

/// Whether the circumcenter of a triangle of slab s lies between the slab's lines.
bool lies_in_slab(const DistributedMesh &mesh, std::size_t s, Point a, Point b, Point c) {
  if (s > 0 && exact::circumcenter_is_left(a, b, c, {mesh.lines[s - 1], mesh.axis}))
    return false;
  return s == mesh.lines.size() || exact::circumcenter_is_left(a, b, c, {mesh.lines[s], mesh.axis});
}

bool is_counter_clockwise(const SlabMesh &slab, LocalIndex triangle) {
  return dovetail::is_counter_clockwise(slab.vertices.points, slab.triangles, triangle);
}

bool is_locally_delaunay(const SlabMesh &slab, LocalIndex triangle, Point apex) {
  const LocalIndex *corners = &slab.triangles.corners[at(3 * triangle)];
  return dovetail::is_locally_delaunay(point_of(slab, corners[0]), point_of(slab, corners[1]),
                                       point_of(slab, corners[2]), apex);
}

void complain_of_edge(const SlabMesh &slab, int s, LocalIndex triangle, GlobalIndex apex, Point p,
                      Findings &findings) {
  findings.add(ViolationKind::delaunay, [&] {
    return fmt::format("{}: site {} {} beyond its edge is inside its circle", place_of(slab, s, triangle),
                       apex, text_of(p));
  });
}

void check_inner_side(const SlabMesh &slab, int s, LocalIndex side, bool oriented, Findings &findings) {
  const LocalIndex triangle = side / 3;
  const LocalIndex neighbour = slab.triangles.neighbours[at(side)];
  if (neighbour == none)
    return;
  const Side edge = side_of(slab, side);
  if (!adjacency_is_symmetric(slab.triangles, triangle, side % 3)) {
    findings.add(ViolationKind::adjacency, [&] {
      return fmt::format("{}: its neighbour {} across the edge of sites {} and {} does not answer",
                         place_of(slab, s, triangle), slab.first_triangle + neighbour,
                         number_of(slab, edge.from), number_of(slab, edge.to));
    });
    return;
  }
  if (neighbour < triangle)
    return; // looked at from there
  ++findings.counts.inner_edges;
  LocalIndex apex = none;
  for (LocalIndex i = 0; i < 3; ++i)
    if (const LocalIndex v = slab.triangles.corners[at(3 * neighbour + i)]; v != edge.from && v != edge.to)
      apex = v;
  if (oriented && apex != none && !is_locally_delaunay(slab, triangle, point_of(slab, apex)))
    complain_of_edge(slab, s, triangle, number_of(slab, apex), point_of(slab, apex), findings);
}

} // namespace

void gather_triangles(const DistributedMesh &common, const SlabMesh &slab, int s, ProgressCount &done,
                      Findings &findings) {
  constexpr LocalIndex interval = 1 << 16;
  const LocalIndex count = slab.triangles.triangle_count();
  for (LocalIndex t = 0; t < count; ++t) {
    if ((t + 1) % interval == 0)
      done.add(interval);
    const LocalIndex *corners = &slab.triangles.corners[at(3 * t)];
    const bool oriented = is_counter_clockwise(slab, t);
    if (!oriented)
      findings.add(ViolationKind::orientation,
                   [&] { return place_of(slab, s, t) + ": is not counter-clockwise"; });
    else if (!lies_in_slab(common, at(s), point_of(slab, corners[0]), point_of(slab, corners[1]),
                           point_of(slab, corners[2])))
      findings.add(ViolationKind::slab,
                   [&] { return place_of(slab, s, t) + ": its circumcenter is outside the slab"; });
    for (LocalIndex i = 0; i < 3; ++i)
      check_inner_side(slab, s, 3 * t + i, oriented, findings);
  }
  done.add(count % interval);
}

void gather_borders(const SlabMesh &slab, int s, Gathered &gathered) {
  for (const BorderSide &border : slab.border_sides) {
    const Side edge = side_of(slab, border.side);
    const LocalIndex triangle = border.side / 3;
    gathered.borders.push_back({slab.first_triangle + triangle, border.neighbour, number_of(slab, edge.from),
                                number_of(slab, edge.to), number_of(slab, edge.apex),
                                point_of(slab, edge.from), point_of(slab, edge.to), point_of(slab, edge.apex),
                                s, is_counter_clockwise(slab, triangle) ? 1 : 0});
  }
}

namespace {

std::string place_of(const BorderNotice &notice) {
  return fmt::format("slab {}, triangle {} (sites {}, {}, {})", notice.slab, notice.triangle, notice.from,
                     notice.to, notice.apex);
}

/// What both notices of one edge between two triangles have in common.
auto border_of(const BorderNotice &notice) {
  return std::tuple(std::min(notice.triangle, notice.neighbour), std::max(notice.triangle, notice.neighbour),
                    std::min(notice.from, notice.to), std::max(notice.from, notice.to));
}

/// The notices of one border edge: there must be two that answer each other. If they do for every edge, then
/// adjacency is symmetric.
void check_border(std::span<const BorderNotice> notices, Findings &findings) {
  const BorderNotice &first = notices.front();
  const BorderNotice &second = notices.back();
  if (notices.size() != 2 || first.triangle != second.neighbour || first.from != second.to) {
    findings.add(ViolationKind::adjacency, [&] {
      return fmt::format(
          "{}: triangle {}, which it has as neighbour across the border edge of sites {} and {}, "
          "does not answer",
          place_of(first), first.neighbour, first.from, first.to);
    });
    return;
  }
  ++findings.counts.inner_edges;
  ++findings.counts.border_edges;
  if (first.oriented == 1 &&
      !dovetail::is_locally_delaunay(first.from_point, first.to_point, first.apex_point, second.apex_point))
    findings.add(ViolationKind::delaunay, [&] {
      return fmt::format("{}: site {} {} beyond its edge is inside its circle", place_of(first), second.apex,
                         text_of(second.apex_point));
    });
}

} // namespace

/// Both sides of a border meet at the rank of the lower triangle.
void check_borders(const Communicator &comm, const Ownership &owners, const Gathered &gathered,
                   Findings &findings) {
  auto notices = deliver(comm, gathered.borders, [&](const BorderNotice &notice) {
    return owners.rank_of_triangle(std::min(notice.triangle, notice.neighbour));
  });
  std::ranges::sort(notices, {}, [](const BorderNotice &notice) {
    return std::tuple_cat(border_of(notice), std::tuple(notice.triangle));
  });
  for (std::size_t begin = 0, end = 0; begin < notices.size(); begin = end) {
    while (end < notices.size() && border_of(notices[end]) == border_of(notices[begin]))
      ++end;
    check_border(std::span(notices).subspan(begin, end - begin), findings);
  }
}

} // namespace dovetail::validation
