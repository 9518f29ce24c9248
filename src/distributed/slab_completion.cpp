#include "slab_completion.hpp"

#include "dovetail/distributed/triangulate_region.hpp"
#include "dovetail/mesh/divide_and_conquer.hpp"
#include "dovetail/mesh/half_edge.hpp"
#include "open_sides.hpp"

#include <algorithm>
#include <cstdint>

namespace dovetail::insertion {
namespace {

/// The triangles of a path's sites alone that are beyond its line: left of it or not. Corners are positions
/// on the path.
Triangulation triangles_beyond(const Path &path, SplitLine line, bool left) {
  std::vector<Point> points;
  std::ranges::transform(path, std::back_inserter(points), &PathSite::point);
  Triangulation triangles = delaunay(points);
  std::vector<LocalIndex> others;
  for (LocalIndex t = 0; t < triangles.triangle_count(); ++t) {
    const LocalIndex *corner = &triangles.corners[3 * at(t)];
    if (circumcenter_is_left(points[at(corner[0])], points[at(corner[1])], points[at(corner[2])], line) !=
        left)
      others.push_back(t);
  }
  remove_triangles(triangles, others);
  return triangles;
}

void append(const Triangulation &part, const Path &path, GrowingSlab &slab) {
  std::vector<LocalIndex> vertices;
  for (const PathSite &site : path)
    vertices.push_back(slab.vertex_of(site.number));
  Triangulation &all = slab.triangles();
  const LocalIndex first = all.triangle_count();
  for (const LocalIndex corner : part.corners)
    all.corners.push_back(vertices[at(corner)]);
  for (const LocalIndex neighbour : part.neighbours)
    all.neighbours.push_back(neighbour == none ? none : first + neighbour);
}

/// An edge with a triangle on one of its sides.
struct OpenEdge {
  std::uint64_t ends; ///< the lower one above the higher one
  HalfEdge side;
};

/// Joins the triangles on both sides of an edge, of which `open` lists the sides without a neighbour.
void join_open_sides(Triangulation &triangles, std::span<const HalfEdge> open) {
  std::vector<OpenEdge> edges;
  edges.reserve(open.size());
  for (const HalfEdge side : open) {
    const auto [low, high] = std::minmax({origin(triangles, side), target(triangles, side)});
    edges.push_back(
        {std::uint64_t{static_cast<std::uint32_t>(low)} << 32 | static_cast<std::uint32_t>(high), side});
  }
  std::ranges::sort(edges, {}, &OpenEdge::ends);
  for (std::size_t i = 1; i < edges.size(); ++i)
    if (edges[i].ends == edges[i - 1].ends) {
      triangles.neighbours[at(edges[i - 1].side)] = triangle_of(edges[i].side);
      triangles.neighbours[at(edges[i].side)] = triangle_of(edges[i - 1].side);
    }
}

} // namespace

void complete_slab(GrowingSlab &slab, const SlabPaths &paths, const SlabLines &lines) {
  Triangulation &triangles = slab.triangles();
  std::vector<HalfEdge> open = open_sides(slab.old_slab());
  const auto own_sides = static_cast<LocalIndex>(triangles.neighbours.size());
  if (const std::optional<SplitLine> &line = lines.left())
    append(triangles_beyond(paths.old_left, *line, true), paths.old_left, slab);
  if (const std::optional<SplitLine> &line = lines.right())
    append(triangles_beyond(paths.old_right, *line, false), paths.old_right, slab);
  for (HalfEdge side = own_sides; side < static_cast<LocalIndex>(triangles.neighbours.size()); ++side)
    if (triangles.neighbours[at(side)] == none)
      open.push_back(side);
  join_open_sides(triangles, open);
}

} // namespace dovetail::insertion
