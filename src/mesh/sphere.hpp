/// The triangulation that divide and conquer works on, and its smallest parts. Private to it.
///
/// A part of n >= 2 sites is kept as a triangulated *sphere*: beyond every directed hull edge lies a ghost
/// triangle, whose third corner is the one point at infinity. By Euler's relation such a sphere has exactly
/// 2n - 2 triangles, whether the sites are collinear or not. So the part of sites [s, s + n) owns the
/// triangles [2s, 2s + 2n - 2), nothing is ever allocated, and a merge finds the two triangles it must add
/// lying free between its parts: 2(s + n_left) - 2 and 2(s + n_left) - 1.
///
/// A half-edge is 3 * triangle + i. `corner[h]` is the vertex of its triangle that lies *across* from it,
/// `twin[h]` the opposite half-edge; around a triangle they follow each other counter-clockwise. So the half
/// edge h of a triangle t = 3 * triangle goes from corner[after(h, t)] to corner[before(h, t)], and what a
/// merge looks at most often, the apex behind an edge, is one look-up. A ghost beyond the hull edge u -> v
/// (the hull seen counter-clockwise, the sites on its left) always begins with the half-edge on that edge:
///
///                 infinity               corner across   twin
///                  /    \       h + 0    infinity        the half-edge u -> v inside
///         h + 2   /      \      h + 1    v               third of the ghost before, whose edge ends at u
///                /        \     h + 2    u               second of the ghost after, whose edge begins at v
///               v -------- u
///                  h + 0
///
/// So a ghost is named by its h + 0, the ghost after it is twin[h + 2] - 1, the one before twin[h + 1] - 2.
/// Collinear sites are all ghosts: a ring that goes along the line and back.
#pragma once

#include "dovetail/geometry/predicates.hpp"
#include "sight.hpp"

#include <algorithm>
#include <cstdint>

namespace dovetail::divide_and_conquer {

/// Numbers on their way between arrays of LocalIndex: as wide as a register, which saves extending them again
/// and again.
using Vertex = std::int64_t;
using HalfEdge = std::int64_t;
constexpr LocalIndex narrow(std::int64_t number) { return static_cast<LocalIndex>(number); }

/// The ghosts that begin at the extreme vertices of a part in the two orders of cutting, (x, y) and (y, x).
/// Extremes in an order are true corners of the hull: just one ghost begins there.
struct Hull {
  HalfEdge first[2]; ///< [axis]: at the least vertex
  HalfEdge last[2];  ///< at the greatest
};

constexpr bool less_along(Point a, Point b, unsigned axis) {
  const double a_major = axis == 0 ? a.x : a.y, a_minor = axis == 0 ? a.y : a.x;
  const double b_major = axis == 0 ? b.x : b.y, b_minor = axis == 0 ? b.y : b.x;
  return (a_major < b_major) | ((a_major == b_major) & (a_minor < b_minor)); // no branch on data
}

/// Sites: gives a Point for a Vertex, and `far_away` for `infinity`.
template <class Sites> struct Sphere {
  Sites site;
  LocalIndex *corner;
  LocalIndex *twin;
  Vertex infinity;
  Filter filter;

  static HalfEdge triangle_of(HalfEdge h) {
    return static_cast<HalfEdge>(static_cast<std::uint32_t>(h) / 3) * 3;
  }
  static HalfEdge before(HalfEdge h, HalfEdge triangle) {
    return h - 1 + 3 * static_cast<HalfEdge>(h == triangle); // no branch: any of the three is as likely
  }
  HalfEdge ghost_after(HalfEdge ghost) const { return twin[ghost + 2] - 1; }
  HalfEdge ghost_before(HalfEdge ghost) const { return twin[ghost + 1] - 2; }
  Vertex begin_of(HalfEdge ghost) const { return corner[ghost + 2]; }
  Vertex end_of(HalfEdge ghost) const { return corner[ghost + 1]; }

  void join(HalfEdge a, HalfEdge b) const {
    twin[a] = narrow(b);
    twin[b] = narrow(a);
  }
  void chain(HalfEdge ghost, HalfEdge next) const { join(ghost + 2, next + 1); }
  /// The triangle whose half-edges are b -> c, c -> a and a -> b.
  void set_corners(HalfEdge triangle, Vertex a, Vertex b, Vertex c) const {
    corner[triangle] = narrow(a);
    corner[triangle + 1] = narrow(b);
    corner[triangle + 2] = narrow(c);
  }
  /// The ghost beyond the hull edge u -> v.
  void set_ghost(HalfEdge ghost, Vertex u, Vertex v) const { set_corners(ghost, infinity, v, u); }

  Sign turn(Vertex a, Vertex b, Vertex c) const { return turn(site[a], site[b], site[c]); }
  Sign turn(Point a, Point b, Point c) const;
  bool is_inside(Vertex l, Vertex r, Vertex p, Vertex q) const;
  bool tie_is_inside(Point l, Point r, Point p, Point q) const;

  Hull two_sites(Vertex first) const;
  Hull three_sites(Vertex first) const;
  bool four_sites(Vertex first, Hull &hull) const;
  Hull chain_of_three(HalfEdge base, Vertex a, Vertex b, Vertex c) const;
  Hull hull_of(const HalfEdge *ghosts, unsigned count) const;
  Hull hull_of_ties(const HalfEdge *ghosts, unsigned count) const;

  Hull merge(const Hull &left, const Hull &right, unsigned axis, HalfEdge spare) const;
  template <unsigned axis> Hull merge_along(const Hull &left, const Hull &right, HalfEdge spare) const;
};

template <class Sites> Sign Sphere<Sites>::turn(Point a, Point b, Point c) const {
  if (!filter.turns_are_exact)
    return orientation(a, b, c);
  const double height = look(c, a, b).im;
  return height > 0 ? Sign::positive : height < 0 ? Sign::negative : Sign::zero;
}

/// Is q inside the circle of l, r, p, where p is above l -> r? For what the bounds of a merge do not decide.
template <class Sites>
[[gnu::noinline]] bool Sphere<Sites>::is_inside(Vertex l, Vertex r, Vertex p, Vertex q) const {
  if (q == infinity)
    return false;
  const Sight p_seen = look(site[p], site[l], site[r]);
  const Sight q_seen = look(site[q], site[l], site[r]);
  const double determinant = circle_determinant(p_seen, q_seen);
  const double p_size = std::fabs(p_seen.re) + std::fabs(p_seen.im);
  const double q_size = std::fabs(q_seen.re) + std::fabs(q_seen.im);
  if (std::fabs(determinant) > filter.bounds(p_size, q_size).circle)
    return determinant > 0;
  if (std::max(p_size, q_size) <= filter.exact_z)
    return tie_is_inside(site[l], site[r], site[p], site[q]);
  return in_circle(site[l], site[r], site[p], site[q]) == Sign::positive;
}

/// The same for four that are known to be on one circle, by the rule of in_circle: the height of the greatest
/// site decides.
template <class Sites> bool Sphere<Sites>::tie_is_inside(Point l, Point r, Point p, Point q) const {
  const Point greatest_base = lexicographically_less(l, r) ? r : l;
  const Point greatest_apex = lexicographically_less(p, q) ? q : p;
  if (lexicographically_less(greatest_base, greatest_apex))
    return greatest_apex == p && turn(l, r, q) == Sign::positive;
  return greatest_base == l ? turn(q, r, p) == Sign::positive : turn(l, q, p) == Sign::positive;
}

} // namespace dovetail::divide_and_conquer
