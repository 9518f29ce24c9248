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
#include <utility>

namespace dovetail::divide_and_conquer {

using Vertex = LocalIndex;
using HalfEdge = LocalIndex;

/// The ghosts that begin at the four extreme vertices of a part, by each of the two orders of cutting.
struct Hull {
  HalfEdge first[2]; ///< [0]: at the least vertex by (x, y), [1]: by (y, x)
  HalfEdge last[2];  ///< at the greatest
};

constexpr bool less_along(Point a, Point b, unsigned axis) {
  return axis == 0 ? lexicographically_less(a, b) : a.y < b.y || (a.y == b.y && a.x < b.x);
}

/// Sites: what gives a Point for a Vertex, not-a-number for `ghost`.
template <class Sites> struct Sphere {
  Sites site;
  Vertex *origin;
  HalfEdge *twin;
  Vertex ghost_vertex; ///< the point at infinity
  double guard;        ///< of the filter: see sight.hpp

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

template <class Sites> Hull Sphere<Sites>::two_sites(Vertex a) const {
  const Vertex b = a + 1;
  const HalfEdge ab = 6 * a;
  const HalfEdge ba = ab + 3;
  set_ghost(ab, a, b);
  set_ghost(ba, b, a);
  join(ab, ba);
  chain(ab, ba);
  chain(ba, ab);
  Hull hull;
  for (unsigned axis = 0; axis < 2; ++axis) {
    const bool ascending = less_along(site[a], site[b], axis);
    hull.first[axis] = ascending ? ab : ba;
    hull.last[axis] = ascending ? ba : ab;
  }
  return hull;
}

/// Three collinear sites, b in the middle.
template <class Sites> Hull Sphere<Sites>::chain_of_three(HalfEdge base, Vertex a, Vertex b, Vertex c) const {
  const HalfEdge ab = base;
  const HalfEdge bc = base + 3;
  const HalfEdge cb = base + 6;
  const HalfEdge ba = base + 9;
  set_ghost(ab, a, b);
  set_ghost(bc, b, c);
  set_ghost(cb, c, b);
  set_ghost(ba, b, a);
  join(ab, ba);
  join(bc, cb);
  chain(ab, bc);
  chain(bc, cb);
  chain(cb, ba);
  chain(ba, ab);
  Hull hull;
  for (unsigned axis = 0; axis < 2; ++axis) {
    const bool ascending = less_along(site[a], site[c], axis);
    hull.first[axis] = ascending ? ab : cb;
    hull.last[axis] = ascending ? cb : ab;
  }
  return hull;
}

template <class Sites> Hull Sphere<Sites>::three_sites(Vertex first) const {
  Vertex a = first;
  Vertex b = first + 1;
  Vertex c = first + 2;
  const HalfEdge base = 6 * first;
  const Sign turn = orientation(site[a], site[b], site[c]);
  if (turn == Sign::zero) {
    if (lexicographically_less(site[b], site[a]))
      std::swap(a, b);
    if (lexicographically_less(site[c], site[b]))
      std::swap(b, c);
    if (lexicographically_less(site[b], site[a]))
      std::swap(a, b);
    return chain_of_three(base, a, b, c);
  }
  if (turn == Sign::negative)
    std::swap(b, c);
  const HalfEdge ab = base + 3;
  const HalfEdge bc = base + 6;
  const HalfEdge ca = base + 9;
  set_origins(base, a, b, c);
  set_ghost(ab, a, b);
  set_ghost(bc, b, c);
  set_ghost(ca, c, a);
  join(base, ab);
  join(base + 1, bc);
  join(base + 2, ca);
  chain(ab, bc);
  chain(bc, ca);
  chain(ca, ab);
  Hull hull;
  for (unsigned axis = 0; axis < 2; ++axis) {
    HalfEdge least = ab;
    HalfEdge greatest = ab;
    for (const HalfEdge ghost : {bc, ca}) {
      if (less_along(site[origin[ghost + 1]], site[origin[least + 1]], axis))
        least = ghost;
      if (less_along(site[origin[greatest + 1]], site[origin[ghost + 1]], axis))
        greatest = ghost;
    }
    hull.first[axis] = least;
    hull.last[axis] = greatest;
  }
  return hull;
}

template <class Sites> bool Sphere<Sites>::is_inside_exactly(Vertex l, Vertex r, Vertex p, Vertex q) const {
  return in_circle(site[l], site[r], site[p], site[q]) == Sign::positive;
}

/// Zips two parts together. Every site of `left` must be less than every site of `right` in the order of
/// `axis`; `spare` is the first of the two free triangles.
template <class Sites>
Hull Sphere<Sites>::merge(const Hull &left, const Hull &right, unsigned axis, HalfEdge spare) const {
  // The lower tangent, from the pair of vertices that certainly see each other. Ties stay at the nearer
  // vertex, so that no site lies on the tangent between its ends.
  HalfEdge left_rim = left.last[axis];    // begins at l
  HalfEdge right_rim = right.first[axis]; // begins at r
  Vertex l = origin[left_rim + 1];
  Vertex r = origin[right_rim + 1];
  const Vertex extreme[4] = {origin[left.first[0] + 1], origin[left.first[1] + 1], origin[left.last[0] + 1],
                             origin[left.last[1] + 1]};
  const Vertex extreme_right[4] = {origin[right.first[0] + 1], origin[right.first[1] + 1],
                                   origin[right.last[0] + 1], origin[right.last[1] + 1]};
  for (bool moved = true; moved;) {
    moved = false;
    for (HalfEdge before = ghost_before(left_rim); turns_right(l, r, origin[before + 1]);
         before = ghost_before(left_rim)) {
      left_rim = before;
      l = origin[before + 1];
      moved = true;
    }
    while (turns_right(l, r, origin[right_rim])) {
      r = origin[right_rim];
      right_rim = ghost_after(right_rim);
      moved = true;
    }
  }
  const HalfEdge hull_before = ghost_before(left_rim); // ends at the lower l
  const HalfEdge hull_after = right_rim;               // begins at the lower r
  const HalfEdge bottom = spare;
  const HalfEdge top = spare + 3;
  const Vertex bottom_l = l;
  set_ghost(bottom, l, r);
  HalfEdge below = bottom;
  // A part that is a mere segment can be used up on both sides, back to where it began. Its chain then comes
  // to the bottom ghost, whose far vertex is never above the base.
  right_rim = ghost_before(right_rim);
  chain(hull_before, bottom);
  chain(bottom, hull_after);

  // left_rim and right_rim are heads of two chains of triangles to be replaced, each beyond one edge of the
  // upward boundary: l -> origin[left_rim], and origin[right_rim + 1] -> r.
  Point at_l = site[l];
  Point at_r = site[r];
  for (;;) {
    Vertex left_next = origin[left_rim];
    Vertex right_next = origin[right_rim + 1];
    Sight left_seen = look(site[left_next], at_l, at_r);
    Sight right_seen = look(site[right_next], at_l, at_r);
    const bool left_valid = is_above(l, r, left_next, left_seen);
    const bool right_valid = is_above(l, r, right_next, right_seen);
    if (left_valid) {
      for (;;) {
        const HalfEdge inner = twin[left_rim];
        const HalfEdge triangle = triangle_of(inner);
        const Vertex apex = origin[before(inner, triangle)];
        const Sight seen = look(site[apex], at_l, at_r);
        if (!is_inside(l, r, left_next, left_seen, apex, seen))
          break;
        join(left_rim, twin[after(inner, triangle)]);
        join(triangle, twin[before(inner, triangle)]);
        set_ghost(triangle, l, apex);
        twin[triangle + 2] = left_rim + 1;
        left_rim = triangle;
        left_next = apex;
        left_seen = seen;
      }
    } else if (!right_valid) {
      break;
    }
    if (right_valid) {
      for (;;) {
        const HalfEdge inner = twin[right_rim];
        const HalfEdge triangle = triangle_of(inner);
        const Vertex apex = origin[before(inner, triangle)];
        const Sight seen = look(site[apex], at_l, at_r);
        if (!is_inside(l, r, right_next, right_seen, apex, seen))
          break;
        join(right_rim, twin[before(inner, triangle)]);
        join(triangle, twin[after(inner, triangle)]);
        set_ghost(triangle, apex, r);
        twin[triangle + 1] = right_rim + 2;
        right_rim = triangle;
        right_next = apex;
        right_seen = seen;
      }
    }
    if (!left_valid || (right_valid && is_inside(l, r, left_next, left_seen, right_next, right_seen))) {
      const HalfEdge triangle = right_rim;
      const HalfEdge inner = twin[triangle];
      right_rim = ghost_before(triangle);
      set_origins(triangle, l, r, right_next);
      join(triangle, below);
      join(triangle + 1, inner);
      below = triangle + 2;
      r = right_next;
      at_r = site[r];
    } else {
      const HalfEdge triangle = left_rim;
      const HalfEdge inner = twin[triangle];
      left_rim = ghost_after(triangle);
      set_origins(triangle, l, r, left_next);
      join(triangle, below);
      join(triangle + 2, inner);
      below = triangle + 1;
      l = left_next;
      at_l = site[l];
    }
  }
  set_ghost(top, r, l);
  join(top, below);
  chain(right_rim, top);
  chain(top, left_rim);

  // A ghost that began at an end of a tangent may be gone; the tangent's own begins there now.
  const HalfEdge left_ghost[4] = {left.first[0], left.first[1], left.last[0], left.last[1]};
  const HalfEdge right_ghost[4] = {right.first[0], right.first[1], right.last[0], right.last[1]};
  HalfEdge result[4];
  for (unsigned i = 0; i < 4; ++i) {
    const bool order = less_along(site[extreme[i]], site[extreme_right[i]], i % 2);
    const bool from_left = i < 2 ? order : !order;
    if (from_left)
      result[i] = extreme[i] == bottom_l ? bottom : left_ghost[i];
    else
      result[i] = extreme_right[i] == r ? top : right_ghost[i];
  }
  return {{result[0], result[1]}, {result[2], result[3]}};
}

} // namespace dovetail::divide_and_conquer
