// Triangles and the edges between them: inside a slab, across borders, and on the hull.
#include "validation.hpp"

#include "dovetail/geometry/predicates.hpp"
#include "dovetail/mesh/validate.hpp"

#include <fmt/format.h>

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

void check_triangles(const DistributedMesh &mesh, Findings &findings, const Progress &progress) {
  GlobalIndex all = 0;
  for (const SlabMesh &slab : mesh.slabs)
    all += slab.triangles.triangle_count();
  constexpr GlobalIndex interval = 1 << 16;
  GlobalIndex done = 0;
  int s = mesh.first_slab;
  for (const SlabMesh &slab : mesh.slabs) {
    for (LocalIndex t = 0; t < slab.triangles.triangle_count(); ++t) {
      if (++done % interval == 0)
        report_progress(progress, "check", static_cast<double>(done) / static_cast<double>(all));
      const LocalIndex *corners = &slab.triangles.corners[at(3 * t)];
      const bool oriented = is_counter_clockwise(slab, t);
      if (!oriented)
        findings.add(ViolationKind::orientation,
                     [&] { return place_of(slab, s, t) + ": is not counter-clockwise"; });
      else if (!lies_in_slab(mesh, at(s), point_of(slab, corners[0]), point_of(slab, corners[1]),
                             point_of(slab, corners[2])))
        findings.add(ViolationKind::slab,
                     [&] { return place_of(slab, s, t) + ": its circumcenter is outside the slab"; });
      for (LocalIndex i = 0; i < 3; ++i)
        check_inner_side(slab, s, 3 * t + i, oriented, findings);
    }
    ++s;
  }
}

namespace {

/// What the triangle on one side of a border tells the one on the other.
struct BorderNotice {
  GlobalIndex triangle;  ///< that tells
  GlobalIndex neighbour; ///< that is told
  GlobalIndex from, to;  ///< the edge as the teller has it, in global site numbers
  GlobalIndex apex;
  Point apex_point;
};

std::vector<BorderNotice> border_notices(const DistributedMesh &mesh) {
  std::vector<BorderNotice> notices;
  for (const SlabMesh &slab : mesh.slabs)
    for (const BorderSide &border : slab.border_sides) {
      const Side edge = side_of(slab, border.side);
      notices.push_back({slab.first_triangle + border.side / 3, border.neighbour, number_of(slab, edge.from),
                         number_of(slab, edge.to), number_of(slab, edge.apex), point_of(slab, edge.apex)});
    }
  return notices;
}

bool lists_border(const SlabMesh &slab, LocalIndex side, GlobalIndex neighbour) {
  const auto found = std::lower_bound(slab.border_sides.begin(), slab.border_sides.end(), side,
                                      [](const BorderSide &border, LocalIndex s) { return border.side < s; });
  return found != slab.border_sides.end() && found->side == side && found->neighbour == neighbour;
}

/// Every border side is told to its neighbour. If the one that is told has the same edge the other way round
/// with the teller beyond, for every notice, then adjacency is symmetric: each side of a border tells the
/// other.
void check_notice(const SlabMesh &slab, int s, const BorderNotice &notice, Findings &findings) {
  const auto triangle = static_cast<LocalIndex>(notice.neighbour - slab.first_triangle);
  LocalIndex side = none;
  for (LocalIndex i = 3 * triangle; i < 3 * triangle + 3; ++i) {
    const Side edge = side_of(slab, i);
    if (number_of(slab, edge.from) == notice.to && number_of(slab, edge.to) == notice.from &&
        lists_border(slab, i, notice.triangle))
      side = i;
  }
  if (side == none) {
    findings.add(ViolationKind::adjacency, [&] {
      return fmt::format(
          "{}: does not answer triangle {}, which has it as neighbour across the border edge of "
          "sites {} and {}",
          place_of(slab, s, triangle), notice.triangle, notice.from, notice.to);
    });
    return;
  }
  if (notice.triangle < notice.neighbour)
    return; // looked at from there
  ++findings.counts.inner_edges;
  ++findings.counts.border_edges;
  if (is_counter_clockwise(slab, triangle) && !is_locally_delaunay(slab, triangle, notice.apex_point))
    complain_of_edge(slab, s, triangle, notice.apex, notice.apex_point, findings);
}

} // namespace

void check_borders(const Communicator &comm, const DistributedMesh &mesh, const Ownership &owners,
                   Findings &findings) {
  const auto received = deliver(
      comm, [&] { return border_notices(mesh); },
      [&](const BorderNotice &notice) { return owners.rank_of_triangle(notice.neighbour); });
  for (const BorderNotice &notice : received) {
    const int s = owners.slab_of_triangle(notice.neighbour);
    check_notice(mesh.slabs[at(s - mesh.first_slab)], s, notice, findings);
  }
}

} // namespace dovetail::validation
