/// The constrained Delaunay triangulation of what lies on one side of a new segment. Private to mesh.
#pragma once

#include "dovetail/base/types.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dovetail {

/// A variant of the algorithm of Shewchuk and Brown (Fast segment insertion and incremental construction of
/// constrained Delaunay triangulations, 2015): vertices are taken off the polygon in random order and come
/// back, last off first in, into the constrained Delaunay triangulation of what there is.
///
/// The polygon is the union of what lies left of the segment v0 vm of the triangles that it crossed; its
/// other sides are the chain v0 v1 ... vm. An edge across the segment ends in every inner vertex of the
/// chain; call its part on our side the vertex's ray. Rays do not cross. Only vertices where the polygon is
/// convex are taken off, and each of them is an ear, now and later:
///
///        u          Let p, u, n follow each other on the chain, and the polygon be convex at u. Between the
///      / . \        rays of p and n it is the pentagon of their feet, n, u and p. The quadrangle without u
///     p- . -n       is simple, for pn crosses neither ray (it meets them at their ends) nor the segment
///     (both .  .   .      are on one side); so the pentagon consists of it and the triangle n u p, which
///     holds
///   v0---------vm   no other vertex. The quadrangle takes the pentagon's place between the same two rays.
///
/// The vertex farthest from the segment (of several, the first) is convex, so all can be taken off. A vertex
/// comes back outside of one edge and sees the rest through this edge alone, so the triangles whose circles
/// hold it are found from there; nothing need be located. A vertex drawn from all of a convex chain has less
/// than four triangles on average when it comes back, which is what makes long convex chains linear.
class CavityPolygon {
public:
  /// `chain`: distinct points, or the same one again where the chain turns around a free end.
  void triangulate(std::span<const Point> chain);

  /// Of triangle j, counter-clockwise: places in the chain.
  std::span<const LocalIndex> corners() const { return corner_; }
  /// Of side i of triangle j, at [3j + i]: the half-edge 3j' + i' beyond it, or none on the polygon.
  std::span<const LocalIndex> twins() const { return twin_; }
  /// The half-edge 3j + i inside of the chain's edge from its place k to k + 1; last, that of the segment.
  std::span<const LocalIndex> edges() const { return inside_; }

private:
  using Place = LocalIndex;    ///< in the chain
  using HalfEdge = LocalIndex; ///< 3 * triangle + side

  /// An edge of the cavity around the vertex that comes back, which lies on its left.
  struct Rim {
    Place from, to;
    HalfEdge outside; ///< none on the polygon
  };

  bool convex(Place u) const;
  bool in_conflict(HalfEdge h, Place u) const;
  void take_off();
  void put_back(Place u);
  HalfEdge add_triangle(Place a, Place b, Place c);
  void link(HalfEdge a, HalfEdge b);
  Point point(Place k) const { return chain_[static_cast<std::size_t>(k)]; }

  std::span<const Point> chain_;
  std::vector<Place> before_, after_; ///< on the polygon; of those taken off, at that moment
  std::vector<Place> taken_off_;
  std::vector<Place> candidates_;
  std::vector<std::uint8_t> state_; ///< whether on the polygon, whether among the candidates
  std::vector<Place> corner_;
  std::vector<HalfEdge> twin_;
  std::vector<HalfEdge> inside_; ///< by the first place of the polygon's edge, last: of the segment
  std::vector<Rim> to_dig_;
  std::vector<Rim> rim_;
  std::vector<LocalIndex> free_; ///< triangles to be used again
};

} // namespace dovetail
