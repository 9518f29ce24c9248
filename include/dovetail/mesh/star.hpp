/// The star of a site: the triangles at it, and the link, their edges across from it. Local.
#pragma once

#include "dovetail/mesh/half_edge.hpp"

#include <vector>

namespace dovetail {

/// To be passed again, so that nothing is allocated.
struct Star {
  std::vector<HalfEdge> link; ///< counter-clockwise; their triangles are the star
  bool closed = true;         ///< false: the site is on the border, where the link begins and ends
};

/// The star of the apex of h. O(triangles in it), six on average.
inline void find_star(const Triangulation &mesh, HalfEdge h, Star &star) {
  star.link.clear();
  HalfEdge across = h;
  do { // clockwise, to the border or once around
    const HalfEdge beyond = twin(mesh, before(across));
    if (beyond == none)
      break;
    across = before(beyond);
  } while (across != h);
  star.closed = true;
  const HalfEdge first = across;
  do {
    star.link.push_back(across);
    const HalfEdge beyond = twin(mesh, after(across));
    if (beyond == none) {
      star.closed = false;
      break;
    }
    across = after(beyond);
  } while (across != first);
}

} // namespace dovetail
