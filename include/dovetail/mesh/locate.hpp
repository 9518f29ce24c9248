/// Where a point lies in a mesh: a walk from a triangle given as a hint. Local; reads only.
///
/// Visibility walk (Guibas and Stolfi, 1985; Devillers, Pion and Teillaud, Walking in a triangulation, 2002):
/// from a triangle, cross any side that has the point beyond; never back across the side that one came by.
///
/// Why it ends. Take the power of the point with respect to the circle of the triangle. The circles on both
/// sides of an edge have equal power along its line, and if the edge is locally Delaunay the one ahead has
/// the smaller power beyond; among equals (four on a circle) the perturbation of the canonical rule decides
/// the same way. So the power falls with every step, and no triangle is met twice: not in a Delaunay mesh,
/// and as locked edges are not crossed, not in a constrained one either. More steps than there are triangles
/// are a proof that the mesh is neither, as while it is being flipped; then the choice between two sides is
/// left to chance, and the walk ends with probability one in every triangulation (Devillers, Pion and
/// Teillaud).
///
/// Cost: about one and a half orientations a triangle on the way; from a random triangle to a random point of
/// n uniform sites O(sqrt n) triangles, from a near one O(1).
#pragma once

#include "dovetail/geometry/predicates.hpp"
#include "dovetail/mesh/half_edge.hpp"

#include <cassert>
#include <cstdint>
#include <span>

namespace dovetail {

enum class PlaceKind : std::uint8_t {
  vertex,  ///< the point equals a vertex of the triangle
  edge,    ///< it is inside a side of it, which may be on the hull
  inside,  ///< it is inside the triangle
  outside, ///< it is beyond a side that has no neighbour, strictly
  blocked, ///< it is beyond a side that is locked, strictly
};

struct Place {
  PlaceKind kind;
  LocalIndex triangle;
  int side; ///< for `vertex` the corner; meaningless for `inside`
};

/// The place of a point; `hint` is any triangle. On a locked edge is `edge`, at its ends `vertex`. `outside`
/// means outside of the hull where the border is convex; `outside` and `blocked` mean elsewhere that the walk
/// found no open way on. locked(triangle, side) must be the same from both sides of an edge.
template <class Locked = NothingLocked>
Place locate(std::span<const Point> sites, const Triangulation &mesh, Point point, LocalIndex hint,
             const Locked &locked = {}) {
  assert(hint >= 0 && hint < mesh.triangle_count());
  LocalIndex triangle = hint;
  int entered = none; // the side of `triangle` that has been crossed
  std::uint32_t chance = 1;
  for (LocalIndex steps = 0;; ++steps) {
    if (steps > mesh.triangle_count()) [[unlikely]]
      chance = chance * 1664525 + 1013904223; // Knuth's and Lewis's linear congruential generator
    const int first = entered == none ? 0 : (chance >> 31) == 0 ? side_after(entered) : side_before(entered);
    int closed = none, next = none;
    int zeros = 0, on = 0; // how many sides have the point on their lines; the sum of these sides
    for (int k = 0, side = first; k < 3; ++k, side = side_after(side)) {
      if (side == entered)
        continue;
      const HalfEdge h = half_edge(triangle, side);
      const Sign turn =
          orientation(sites[position(origin(mesh, h))], sites[position(target(mesh, h))], point);
      if (turn == Sign::negative) {
        if (mesh.neighbours[position(h)] != none && !locked(triangle, side)) {
          next = side;
          break;
        }
        closed = side;
      } else if (turn == Sign::zero) {
        ++zeros;
        on += side;
      }
    }
    if (next != none) {
      const LocalIndex ahead = mesh.neighbours[position(half_edge(triangle, next))];
      entered = side_of(half_edge_towards(mesh, ahead, triangle));
      triangle = ahead;
      continue;
    }
    if (closed != none)
      return {mesh.neighbours[position(half_edge(triangle, closed))] == none ? PlaceKind::outside
                                                                             : PlaceKind::blocked,
              triangle, closed};
    // Two sides meet at the corner across from the third.
    return zeros == 0   ? Place{PlaceKind::inside, triangle, 0}
           : zeros == 1 ? Place{PlaceKind::edge, triangle, on}
                        : Place{PlaceKind::vertex, triangle, 3 - on};
  }
}

} // namespace dovetail
