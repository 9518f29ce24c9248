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
  LocalIndex last = cavity.closed ? star_triangle(cavity, first_new, edges - 1) : none;
  LocalIndex triangle = star_triangle(cavity, first_new, 0);
  const LocalIndex first = cavity.closed ? triangle : none;
  for (std::size_t e = 0; e < edges; ++e) {
    const LocalIndex next = e + 1 == edges ? first : star_triangle(cavity, first_new, e + 1);
    const CavityEdge &edge = cavity.edges[e];
    const std::size_t side = position(half_edge(triangle, 0));
    mesh.corners[side] = vertex;
    mesh.corners[side + 1] = edge.from;
    mesh.corners[side + 2] = edge.to;
    mesh.neighbours[side] = none;
    mesh.neighbours[side + 1] = next;
    mesh.neighbours[side + 2] = last;
    if (edge.beyond != none) {
      mesh.neighbours[side] = triangle_of(edge.beyond);
      mesh.neighbours[position(edge.beyond)] = triangle;
    }
    last = triangle;
    triangle = next;
  }
  return first_new;
}

} // namespace dovetail
