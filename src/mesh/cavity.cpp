#include "dovetail/mesh/cavity.hpp"

#include "dovetail/base/error.hpp"
#include "dovetail/mesh/divide_and_conquer.hpp"

namespace dovetail {

LocalIndex commit(Triangulation &mesh, const Cavity &cavity, LocalIndex vertex) {
  const LocalIndex first_new = mesh.triangle_count();
  const std::size_t edges = cavity.edges.size();
  const std::size_t sides = mesh.corners.size() + 3 * (edges - cavity.triangles.size());
  if (sides > 6 * most_delaunay_sites)
    throw Error({ErrorKind::resource, "triangulation", "",
                 "a mesh grows beyond what 32-bit indices can number", "use more slabs"});
  mesh.corners.resize(sides);
  mesh.neighbours.resize(sides);
  LocalIndex *corners = mesh.corners.data(), *neighbours = mesh.neighbours.data();
  const LocalIndex first = star_triangle(cavity, first_new, 0);
  LocalIndex last = first;
  for (std::size_t e = 0; e < edges; ++e) {
    const CavityEdge &edge = cavity.edges[e];
    const LocalIndex triangle = star_triangle(cavity, first_new, e);
    const std::size_t side = position(half_edge(triangle, 0));
    corners[side] = vertex;
    corners[side + 1] = edge.from;
    corners[side + 2] = edge.to;
    neighbours[side] = none;
    if (edge.beyond != none) {
      neighbours[side] = triangle_of(edge.beyond);
      neighbours[position(edge.beyond)] = triangle;
    }
    neighbours[side + 2] = last;
    neighbours[position(half_edge(last, 1))] = triangle; // of the first, until there is a last
    last = triangle;
  }
  neighbours[position(half_edge(first, 2))] = cavity.closed ? last : none;
  neighbours[position(half_edge(last, 1))] = cavity.closed ? first : none;
  return first_new;
}

} // namespace dovetail
