/// Half-edges of a Triangulation: how algorithms that go from triangle to triangle name its sides.
///
/// Half-edge 3t + i is side i of triangle t, across from its corner i. It runs from corner i + 1 to corner
/// i + 2, with its triangle on the left:
///
///                corner i
///                 /    \              twin: the same edge, as a side of the neighbour;
///     side i + 2 /      \ side i + 1        `none` beyond the hull
///               /   t    \            after, before: the next and the last side, counter-clockwise
///        i + 1 ----------- i + 2
///              side i -->
#pragma once

#include "dovetail/mesh/triangulation.hpp"

#include <cstddef>

namespace dovetail {

using HalfEdge = LocalIndex;

constexpr std::size_t position(LocalIndex i) { return static_cast<std::size_t>(i); }

constexpr HalfEdge half_edge(LocalIndex triangle, int side) { return 3 * triangle + side; }
constexpr LocalIndex triangle_of(HalfEdge h) {
  return static_cast<LocalIndex>(static_cast<std::uint32_t>(h) / 3);
}
constexpr int side_of(HalfEdge h) { return h - 3 * triangle_of(h); }

// Any of the three is as likely: no branches.
constexpr int side_after(int side) { return side + 1 - 3 * static_cast<int>(side == 2); }
constexpr int side_before(int side) { return side - 1 + 3 * static_cast<int>(side == 0); }
constexpr HalfEdge after(HalfEdge h) { return h + 1 - 3 * static_cast<HalfEdge>(side_of(h) == 2); }
constexpr HalfEdge before(HalfEdge h) { return h - 1 + 3 * static_cast<HalfEdge>(side_of(h) == 0); }

inline LocalIndex origin(const Triangulation &mesh, HalfEdge h) { return mesh.corners[position(after(h))]; }
inline LocalIndex target(const Triangulation &mesh, HalfEdge h) { return mesh.corners[position(before(h))]; }
/// The corner across.
inline LocalIndex apex(const Triangulation &mesh, HalfEdge h) { return mesh.corners[position(h)]; }

/// The side of `triangle` whose neighbour is `neighbour`, which must be one. Two triangles of a mesh in the
/// plane share one edge at most. Any of the three is as likely, so there is no branch.
inline HalfEdge half_edge_towards(const Triangulation &mesh, LocalIndex triangle, LocalIndex neighbour) {
  const LocalIndex *beyond = &mesh.neighbours[position(half_edge(triangle, 0))];
  return half_edge(triangle,
                   static_cast<int>(beyond[1] == neighbour) + 2 * static_cast<int>(beyond[2] == neighbour));
}

/// The corner of a triangle that is neither a nor b, which must be the other two: exclusive or is its own
/// inverse, so no comparison is needed.
inline LocalIndex third_corner(const Triangulation &mesh, LocalIndex triangle, LocalIndex a, LocalIndex b) {
  const LocalIndex *corner = &mesh.corners[position(half_edge(triangle, 0))];
  return corner[0] ^ corner[1] ^ corner[2] ^ a ^ b;
}

/// The side of a triangle across from one of its corners; no branch here either.
inline HalfEdge side_across(const Triangulation &mesh, LocalIndex triangle, LocalIndex vertex) {
  const LocalIndex *corner = &mesh.corners[position(half_edge(triangle, 0))];
  return half_edge(triangle,
                   static_cast<int>(corner[1] == vertex) + 2 * static_cast<int>(corner[2] == vertex));
}

/// `none` on the hull.
inline HalfEdge twin(const Triangulation &mesh, HalfEdge h) {
  const LocalIndex beyond = mesh.neighbours[position(h)];
  return beyond == none ? none : half_edge_towards(mesh, beyond, triangle_of(h));
}

/// The hull edge that begins where the hull edge h ends, and the one that ends where it begins. They turn
/// about a vertex: as many steps as it has triangles.
inline HalfEdge hull_after(const Triangulation &mesh, HalfEdge h) {
  h = after(h);
  for (HalfEdge across = twin(mesh, h); across != none; across = twin(mesh, h))
    h = after(across);
  return h;
}
inline HalfEdge hull_before(const Triangulation &mesh, HalfEdge h) {
  h = before(h);
  for (HalfEdge across = twin(mesh, h); across != none; across = twin(mesh, h))
    h = before(across);
  return h;
}

/// For algorithms that take a predicate locked(triangle, side): an edge that must not be crossed or changed.
struct NothingLocked {
  constexpr bool operator()(LocalIndex, int) const { return false; }
};

} // namespace dovetail
