#include "dovetail/mesh/flip.hpp"

namespace dovetail {
namespace {

/// What a cavity may not cross if it is to be no larger than where the site lies.
struct EverythingLocked {
  constexpr bool operator()(LocalIndex, int) const { return true; }
};

} // namespace

Insertion insert_by_flips(std::vector<Point> &sites, Triangulation &mesh, Point site, LocalIndex hint,
                          Cavity &memory) {
  if (mesh.triangle_count() == 0)
    return insert(sites, mesh, site, none, memory);
  const Place place = locate(sites, mesh, site, hint != none ? hint : jump(sites, mesh, site));
  if (place.kind == PlaceKind::vertex)
    return {mesh.corners[position(half_edge(place.triangle, place.side))], place.triangle, false};
  find_cavity(sites, mesh, site, place, memory, EverythingLocked{});
  const auto vertex = static_cast<LocalIndex>(sites.size());
  const LocalIndex first_new = commit(mesh, memory, vertex);
  sites.push_back(site);
  for (std::size_t e = 0; e < memory.edges.size(); ++e)
    memory.sides.push_back(half_edge(star_triangle(memory, first_new, e), 0));
  flip_to_delaunay(sites, mesh, memory.sides);
  return {vertex, star_triangle(memory, first_new, 0), true};
}

} // namespace dovetail
