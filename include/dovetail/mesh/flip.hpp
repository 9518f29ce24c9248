/// Edge flips: the reference formulation of insertion. Local.
///
/// An edge that is not locally Delaunay is exchanged for the other diagonal of its two triangles, until there
/// is none; then the triangulation is Delaunay (Lawson, Software for C1 surface interpolation, 1977). By
/// in_circle, which is never undecided, it is the canonical one.
///
///             c                           c
///            / \                         /|\             h: a -> b before,
///           / t \                       / | \               across from corner 0 of t after
///          a --- b        flip(h)      a  |  b
///           \ u /                       \t|u/            c is corner 0 of both t and u
///            \ /                         \|/
///             d                           d
///
/// Where d is inside the circle of a, b, c, the two lie on two sides of a chord, so the quadrilateral is
/// convex (cavity.hpp). Every flip lowers the surface of the sites lifted to the paraboloid, so it ends.
#pragma once

#include "dovetail/mesh/insert.hpp"

#include <vector>

namespace dovetail {

/// Flips the edge h, which must have triangles on both sides that make a convex quadrilateral. O(1).
inline void flip(Triangulation &mesh, HalfEdge h) {
  const HalfEdge across = twin(mesh, h);
  const LocalIndex t = triangle_of(h), u = triangle_of(across);
  const LocalIndex a = origin(mesh, h), b = target(mesh, h), c = apex(mesh, h), d = apex(mesh, across);
  // Beyond the four edges around.
  const HalfEdge ca = twin(mesh, before(h)), bc = twin(mesh, after(h));
  const HalfEdge ad = twin(mesh, after(across)), db = twin(mesh, before(across));
  const auto set = [&mesh](HalfEdge side, LocalIndex corner, HalfEdge beyond) {
    mesh.corners[position(side)] = corner;
    mesh.neighbours[position(side)] = beyond == none ? none : triangle_of(beyond);
    if (beyond != none)
      mesh.neighbours[position(beyond)] = triangle_of(side);
  };
  set(half_edge(t, 0), c, ad);
  set(half_edge(t, 2), d, ca);
  set(half_edge(u, 0), c, db);
  set(half_edge(u, 1), d, bc);
  set(half_edge(t, 1), a, half_edge(u, 2));
  set(half_edge(u, 2), b, half_edge(t, 1));
}

/// Flips until all edges are locally Delaunay or locked, if all but those of `suspicious` (either half-edge)
/// are; it is empty then. Returns the number of flips. After an insertion O(1) on average, in general as many
/// as pairs of sites.
template <class Locked = NothingLocked>
GlobalIndex flip_to_delaunay(std::span<const Point> sites, Triangulation &mesh,
                             std::vector<HalfEdge> &suspicious, const Locked &locked = {}) {
  GlobalIndex flips = 0;
  while (!suspicious.empty()) {
    const HalfEdge h = suspicious.back();
    suspicious.pop_back();
    const HalfEdge across = twin(mesh, h);
    if (across == none || locked(triangle_of(h), side_of(h)) ||
        !is_in_circle(sites, mesh, triangle_of(across), sites[position(apex(mesh, h))]))
      continue;
    flip(mesh, h);
    ++flips;
    const LocalIndex t = triangle_of(h), u = triangle_of(across);
    // The four edges around may have become wrong, no others.
    suspicious.insert(suspicious.end(), {half_edge(t, 0), half_edge(t, 2), half_edge(u, 0), half_edge(u, 1)});
  }
  return flips;
}

/// As `insert` (insert.hpp): the site is joined with the corners around it, then edges are flipped.
Insertion insert_by_flips(std::vector<Point> &sites, Triangulation &mesh, Point site, LocalIndex hint,
                          Cavity &memory);

} // namespace dovetail
