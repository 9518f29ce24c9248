#include "dovetail/mesh/nearest.hpp"

#include "dovetail/geometry/predicates.hpp"
#include "dovetail/mesh/insert.hpp"
#include "dovetail/mesh/locate.hpp"
#include "dovetail/mesh/star.hpp"

#include <cassert>

namespace dovetail {

LocalIndex nearest_site(std::span<const Point> sites, const Triangulation &mesh, Point point,
                        LocalIndex hint) {
  assert(!sites.empty());
  const auto closer = [&](LocalIndex a, LocalIndex b) {
    return nearer(sites[position(a)], sites[position(b)], point);
  };
  if (mesh.triangle_count() == 0) {
    LocalIndex best = 0;
    for (LocalIndex v = 1; position(v) < sites.size(); ++v)
      if (closer(v, best))
        best = v;
    return best;
  }
  const Place place = locate(sites, mesh, point, hint != none ? hint : jump(sites, mesh, point));
  HalfEdge at = half_edge(place.triangle, 0); // the site is its apex
  Star star;
  for (;;) {
    const LocalIndex best = apex(mesh, at);
    find_star(mesh, at, star);
    HalfEdge next = none;
    LocalIndex least = best;
    const auto look = [&](LocalIndex vertex, HalfEdge towards) {
      if (vertex != least && closer(vertex, least)) {
        least = vertex;
        next = towards;
      }
    };
    for (const HalfEdge across : star.link) {
      look(origin(mesh, across), after(across));
      look(target(mesh, across), before(across));
    }
    if (next == none)
      return best;
    at = next;
  }
}

} // namespace dovetail
