/// The merge of Guibas and Stolfi over triangles with ghosts: private to divide and conquer.
///
/// A part of n >= 2 sites is kept as a triangulated *sphere*: every directed hull edge has a ghost triangle
/// beyond it, whose third corner is the one point at infinity, written `ghost_vertex`. By Euler's relation
/// such a sphere has exactly 2n - 2 triangles, whether the sites are collinear or not. So the part of sites
/// [s, s + n) owns the triangles [2s, 2s + 2n - 2), nothing is ever allocated, and a merge finds the two
/// triangles it must add lying free between its parts: 2(s + n_left) - 2 and 2(s + n_left) - 1.
///
/// A half-edge is 3 * triangle + i. `origin[h]` is the vertex it leaves, `twin[h]` the opposite half-edge;
/// around a triangle they follow each other counter-clockwise. A ghost beyond the hull edge u -> v (the hull
/// seen counter-clockwise, the sites on its left) always begins with the half-edge on that edge:
///
///            infinity                     origin           twin
///             /    \            h + 0:    v                the half-edge u -> v inside
///     h + 2  /      \  h + 1    h + 1:    u                second of the ghost before, which ends at u
///           v ------ u          h + 2:    infinity         first of the ghost after, which begins at v
///             h + 0
///
/// so a ghost is named by its h + 0, the ghost after it is twin[h + 2] - 1 and the one before twin[h + 1]
/// - 2.
#pragma once

#include "dovetail/geometry/predicates.hpp"
#include "sight.hpp"

#include <cstdint>

namespace dovetail::divide_and_conquer {

using Vertex = LocalIndex;
using HalfEdge = LocalIndex;

inline constexpr Vertex ghost_vertex = -1;

/// The ghosts that begin at the four extreme vertices of a part, by each of the two orders of cutting.
struct Hull {
  HalfEdge first[2]; ///< [0]: at the least vertex by (x, y), [1]: by (y, x)
  HalfEdge last[2];  ///< at the greatest
};

constexpr bool less_along(Point a, Point b, unsigned axis) {
  return axis == 0 ? lexicographically_less(a, b) : a.y < b.y || (a.y == b.y && a.x < b.x);
}

struct Sphere {
  const Point *site; ///< site[ghost_vertex] exists too, and is not a number
  Vertex *origin;
  HalfEdge *twin;
  double guard; ///< of the filter: see sight.hpp

  static HalfEdge triangle_of(HalfEdge h) {
    return static_cast<HalfEdge>(static_cast<std::uint32_t>(h) / 3 * 3);
  }
  static HalfEdge after(HalfEdge h, HalfEdge triangle) { return h == triangle + 2 ? triangle : h + 1; }
  static HalfEdge before(HalfEdge h, HalfEdge triangle) { return h == triangle ? triangle + 2 : h - 1; }
  HalfEdge ghost_after(HalfEdge ghost) const { return twin[ghost + 2] - 1; }
  HalfEdge ghost_before(HalfEdge ghost) const { return twin[ghost + 1] - 2; }

  void join(HalfEdge a, HalfEdge b) const {
    twin[a] = b;
    twin[b] = a;
  }
  void chain(HalfEdge ghost, HalfEdge after) const { join(ghost + 2, after + 1); }
  void set_origins(HalfEdge triangle, Vertex a, Vertex b, Vertex c) const {
    origin[triangle] = a;
    origin[triangle + 1] = b;
    origin[triangle + 2] = c;
  }
  /// The ghost beyond the hull edge u -> v.
  void set_ghost(HalfEdge ghost, Vertex u, Vertex v) const { set_origins(ghost, v, u, ghost_vertex); }

  bool turns_left(Vertex a, Vertex b, Vertex c) const {
    return orientation(site[a], site[b], site[c]) == Sign::positive;
  }
  bool turns_right(Vertex a, Vertex b, Vertex c) const {
    return orientation(site[a], site[b], site[c]) == Sign::negative;
  }
  bool is_above(Vertex l, Vertex r, Vertex p, Sight seen) const {
    const double bound = height_bound(seen, guard);
    return seen.im > bound || (!(seen.im < -bound) && turns_left(l, r, p));
  }
  /// Is q inside the circle of l, r and p, which is above l -> r? False for the ghost vertex.
  bool is_inside(Vertex l, Vertex r, Vertex p, Sight p_seen, Vertex q, Sight q_seen) const {
    const double determinant = circle_determinant(p_seen, q_seen);
    const double bound = circle_bound(p_seen, q_seen, guard);
    return determinant > bound ||
           (!(determinant < -bound) && q != ghost_vertex && is_inside_exactly(l, r, p, q));
  }
  bool is_inside_exactly(Vertex l, Vertex r, Vertex p, Vertex q) const;

  Hull two_sites(Vertex a) const;
  Hull three_sites(Vertex a) const;
  Hull merge(const Hull &left, const Hull &right, unsigned axis, HalfEdge spare) const;

private:
  Hull chain_of_three(HalfEdge base, Vertex a, Vertex b, Vertex c) const;
};

} // namespace dovetail::divide_and_conquer
