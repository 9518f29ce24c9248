/// Long borders: the Delaunay triangles inside a simple polygon of Delaunay edges, in random order. Private
/// to mesh.
#pragma once

#include "dovetail/mesh/triangulation.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dovetail {

/// Chew's algorithm (Building Voronoi diagrams for convex polygons in linear expected time, 1986), and what
/// becomes of it where the polygon is not convex.
///
/// Vertices are taken out of the polygon in random order, and each remembers its neighbours of that moment;
/// then they come back, last out first in, into the Delaunay triangulation of those that are there. In which
/// triangles' circles a vertex v lies is all that an insertion needs to know, and one such triangle leads to
/// the others. Let S be the vertices before v, a the one that v follows in the polygon of S and v.
///  - In a convex polygon, a and v are neighbours on the hull of S and v. So v lies in the circle of a
///    triangle at a; a is any vertex of S as probably as any other, so it has less than six triangles on
///    average, and so have the vertices that come in. All is expected O(k), whatever the polygon.
///  - In any other polygon of edges that are Delaunay, v need not be a neighbour of a. Then the way from a to
///    v along the polygon is followed: let c and d be neighbours on the polygon, neither between S. Their
///    edge is Delaunay, also in S with both. If no triangle's circle holds both, then d lies in the circle of
///    a triangle c p q that c makes with an edge p q around its triangles. That disk is inside the union of
///    the disks of the two triangles at p q, for its circle is between theirs in the pencil of circles
///    through p and q; one of them holds c and the other does not, so d is in the other. In short: d
///    lies in the circle of one of the triangles of c, or of one of their neighbours. A vertex that is not in
///    S has less than six such triangles on average, so the way costs O(k / |S|) expected, and all ways
///    O(k log k) at most.
/// The exact predicates are those of a perturbed set (include/dovetail/README.md) without cocircular sites,
/// and collinear ones on the hull are settled as if the hull bulged, so that all this holds for all sites.
/// Edges of the whole triangulation are edges of that of any of its sites, so the polygon's are here in the
/// end, and the triangles inside are found from them.
class PolygonTriangulation {
public:
  explicit PolygonTriangulation(std::span<const Point> sites) : sites_(sites) {}

  /// On entry: distinct vertices, counter-clockwise along Delaunay edges around nothing but triangles of
  /// theirs. Appends the corners of these triangles. Always the same order for the same polygon.
  void solve(std::span<const LocalIndex> polygon, std::vector<LocalIndex> &corners);

private:
  using Vertex = LocalIndex; ///< place in the polygon; one more is the point at infinity
  using HalfEdge = LocalIndex;
  using Triangle = LocalIndex;

  void take_out();
  void begin();
  void insert(Vertex v);
  Triangle locate(Vertex v);
  Triangle next_conflict(Triangle start, Vertex c, Vertex d);
  Triangle conflict_at(Vertex a, Vertex v) const;
  bool in_conflict(Triangle t, Vertex v) const;
  void link(HalfEdge a, HalfEdge b);
  void collect(std::span<const LocalIndex> polygon, std::vector<LocalIndex> &corners);
  bool mark(Triangle t);

  Point point(Vertex v) const { return point_[static_cast<std::size_t>(v)]; }
  Vertex origin(HalfEdge h) const { return origin_[static_cast<std::size_t>(h)]; }
  HalfEdge twin(HalfEdge h) const { return twin_[static_cast<std::size_t>(h)]; }

  std::span<const Point> sites_;
  Vertex infinity_ = 0;
  std::vector<Point> point_;
  std::vector<Vertex> order_;     ///< of insertion
  std::vector<Vertex> before_;    ///< on the polygon, when a vertex was taken out
  std::vector<Vertex> after_;     ///< likewise
  std::vector<HalfEdge> leaving_; ///< a half-edge from each vertex
  std::vector<Vertex> origin_;    ///< of half-edge 3t + i, which ends where the next of triangle t begins
  std::vector<HalfEdge> twin_;
  std::vector<std::uint32_t> marked_; ///< by triangle: in which round
  std::uint32_t round_ = 0;
  std::vector<Triangle> cavity_;
  std::vector<HalfEdge> rim_;   ///< half-edges outside of the cavity, twins of its boundary
  std::vector<HalfEdge> spoke_; ///< by vertex: from the new one
};

} // namespace dovetail
