/// Two, three and four sites, solved directly. Private to divide and conquer.
#pragma once

#include "sphere.hpp"

#include <array>
#include <bit>
#include <utility>

namespace dovetail::divide_and_conquer {

/// The extremes of two to four sites. Where no coordinate is as small or as great as another, both axes are
/// done together in the lanes of a vector: 0.4 mispredictions a point less.
template <class Sites> Hull Sphere<Sites>::hull_of(const HalfEdge *ghosts, unsigned count) const {
  std::array<Pair, 4> at;
  at[0] = pair_of(site[begin_of(ghosts[0])]);
  Pair low = at[0], high = at[0];
  for (unsigned i = 1; i < count; ++i) {
    at[i] = pair_of(site[begin_of(ghosts[i])]);
    low = least(low, at[i]);
    high = greatest(high, at[i]);
  }
  unsigned lows = 0, highs = 0; // bit 2 * i + axis: ghost i is the extreme
  for (unsigned i = 0; i < count; ++i) {
    lows |= equal_lanes(at[i], low) << (2 * i);
    highs |= equal_lanes(at[i], high) << (2 * i);
  }
  const auto more_than_one = [](unsigned bits) { return bits & (bits - 1); };
  const unsigned x = 0x55;
  if ((more_than_one(lows & x) | more_than_one(lows & ~x) | more_than_one(highs & x) |
       more_than_one(highs & ~x)) != 0) [[unlikely]]
    return hull_of_ties(ghosts, count);
  const auto extreme = [&](unsigned bits) { return ghosts[std::countr_zero(bits) / 2]; };
  return {{extreme(lows & x), extreme(lows & ~x)}, {extreme(highs & x), extreme(highs & ~x)}};
}

template <class Sites>
[[gnu::noinline]] Hull Sphere<Sites>::hull_of_ties(const HalfEdge *ghosts, unsigned count) const {
  Hull hull;
  for (unsigned axis = 0; axis < 2; ++axis) {
    hull.first[axis] = hull.last[axis] = ghosts[0];
    Point low = site[begin_of(ghosts[0])];
    Point high = low;
    for (unsigned i = 1; i < count; ++i) {
      const Point p = site[begin_of(ghosts[i])];
      const bool less = less_along(p, low, axis);
      const bool greater = less_along(high, p, axis);
      hull.first[axis] = less ? ghosts[i] : hull.first[axis];
      hull.last[axis] = greater ? ghosts[i] : hull.last[axis];
      low = less ? p : low;
      high = greater ? p : high;
    }
  }
  return hull;
}

template <class Sites> Hull Sphere<Sites>::two_sites(Vertex first) const {
  const HalfEdge ghosts[2] = {6 * first, 6 * first + 3};
  set_ghost(ghosts[0], first, first + 1);
  set_ghost(ghosts[1], first + 1, first);
  join(ghosts[0], ghosts[1]);
  chain(ghosts[0], ghosts[1]);
  chain(ghosts[1], ghosts[0]);
  return hull_of(ghosts, 2);
}

/// Three collinear sites, b in the middle.
template <class Sites> Hull Sphere<Sites>::chain_of_three(HalfEdge base, Vertex a, Vertex b, Vertex c) const {
  const HalfEdge ab = base, bc = base + 3, cb = base + 6, ba = base + 9;
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
  const HalfEdge ends[2] = {ab, cb};
  return hull_of(ends, 2);
}

template <class Sites> Hull Sphere<Sites>::three_sites(Vertex first) const {
  Vertex a = first, b = first + 1, c = first + 2;
  const HalfEdge base = 6 * first;
  const Sign sign = turn(a, b, c);
  if (sign == Sign::zero) {
    if (lexicographically_less(site[b], site[a]))
      std::swap(a, b);
    if (lexicographically_less(site[c], site[b]))
      std::swap(b, c);
    if (lexicographically_less(site[b], site[a]))
      std::swap(a, b);
    return chain_of_three(base, a, b, c);
  }
  if (sign == Sign::negative)
    std::swap(b, c);
  const HalfEdge ghosts[3] = {base + 3, base + 6, base + 9};
  set_corners(base, c, a, b);
  set_ghost(ghosts[0], a, b);
  set_ghost(ghosts[1], b, c);
  set_ghost(ghosts[2], c, a);
  for (HalfEdge i = 0; i < 3; ++i)
    join(base + i, ghosts[i]);
  chain(ghosts[0], ghosts[1]);
  chain(ghosts[1], ghosts[2]);
  chain(ghosts[2], ghosts[0]);
  return hull_of(ghosts, 3);
}

/// How four sites in general position lie, by the signs of their four orientations.
struct Arrangement {
  bool convex;                       ///< a, b, c, d counter-clockwise; else d is inside a, b, c
  std::array<std::uint8_t, 4> order; ///< a, b, c, d of 0 .. 3
};

/// Bit i of `signs`: the orientation of the three sites other than i, in ascending order, is positive. Of the
/// weights of the one affine dependence between four points, those with even i have the sign of this
/// orientation, the others the opposite one. Radon: one sign against three is a point inside a triangle, two
/// against two are the diagonals of a quadrilateral.
constexpr Arrangement arrangement_of(unsigned signs) {
  const auto is_positive = [signs](unsigned missing) { return (signs >> missing & 1) != 0; };
  const auto weight = [&](unsigned i) { return is_positive(i) == (i % 2 == 0); };
  unsigned positive = 0;
  for (unsigned i = 0; i < 4; ++i)
    positive += weight(i) ? 1U : 0U;
  Arrangement result{};
  if (positive == 1 || positive == 3) {
    std::uint8_t others[3]{};
    unsigned count = 0;
    unsigned inside = 0;
    for (unsigned i = 0; i < 4; ++i)
      if (weight(i) == (positive == 1))
        inside = i;
      else
        others[count++] = static_cast<std::uint8_t>(i);
    const bool ccw = is_positive(inside);
    result = {false,
              {others[0], others[ccw ? 1 : 2], others[ccw ? 2 : 1], static_cast<std::uint8_t>(inside)}};
  } else if (positive == 2) {
    unsigned across = 1; // the other end of the diagonal from 0
    while (weight(across) != weight(0))
      ++across;
    const unsigned low = across == 1 ? 2 : 1;
    const unsigned high = across == 3 ? 2 : 3;
    // 0, low, across is in ascending order unless across = 1.
    const bool ccw = is_positive(high) != (across == 1);
    result = {true,
              {0, static_cast<std::uint8_t>(ccw ? low : high), static_cast<std::uint8_t>(across),
               static_cast<std::uint8_t>(ccw ? high : low)}};
  }
  return result;
}

inline constexpr std::array<Arrangement, 16> arrangements = [] {
  std::array<Arrangement, 16> all{};
  for (unsigned signs = 0; signs < 16; ++signs)
    all[signs] = arrangement_of(signs);
  return all;
}();

/// The twins in a sphere of four sites, relative to its first half-edge.
///
///   convex                          d inside
///     d-----c   0: a b c                c      0: a b d
///     | 1 / |   1: a c d               /|\     1: b c d
///     |  /  |   ghosts 2 .. 5:        / d \    2: c a d
///     | / 0 |   ab bc cd da          / / \ \   ghosts 3 .. 5:
///     a-----b                       a-------b  ab bc ca
inline constexpr std::array<std::array<LocalIndex, 18>, 2> twins_of_four{{
    {6, 9, 3, 2, 12, 15, 0, 17, 10, 1, 8, 13, 4, 11, 16, 5, 14, 7},
    {9, 5, 7, 12, 8, 1, 15, 2, 4, 0, 17, 13, 3, 11, 16, 6, 14, 10},
}};

/// False, and nothing done, if floating point does not tell how four sites lie.
template <class Sites> bool Sphere<Sites>::four_sites(Vertex first, Hull &hull) const {
  const Point p = site[first];
  double x[3], y[3], size = 0;
  for (Vertex i = 0; i < 3; ++i) {
    x[i] = site[first + 1 + i].x - p.x;
    y[i] = site[first + 1 + i].y - p.y;
    size += x[i] * x[i] + y[i] * y[i];
  }
  // Each product of two differences is wrong by at most 4u size, and so the sum of three by 15u size.
  const double missing_3 = x[0] * y[1] - y[0] * x[1];
  const double missing_2 = x[0] * y[2] - y[0] * x[2];
  const double missing_1 = x[1] * y[2] - y[1] * x[2];
  const double missing_0 = missing_1 - missing_2 + missing_3;
  const double bound = 0x1p-48 * size + filter.guard;
  if (!((std::fabs(missing_0) > bound) & (std::fabs(missing_1) > bound) & (std::fabs(missing_2) > bound) &
        (std::fabs(missing_3) > bound)))
    return false;
  const unsigned signs = (missing_0 > 0 ? 1U : 0U) | (missing_1 > 0 ? 2U : 0U) | (missing_2 > 0 ? 4U : 0U) |
                         (missing_3 > 0 ? 8U : 0U);
  const Arrangement &found = arrangements[signs];
  Vertex v[4];
  for (unsigned i = 0; i < 4; ++i)
    v[i] = first + found.order[i];
  const HalfEdge base = 6 * first;
  const std::array<LocalIndex, 18> &twins = twins_of_four[found.convex ? 0 : 1];
  for (HalfEdge h = 0; h < 18; ++h)
    twin[base + h] = narrow(base) + twins[static_cast<std::size_t>(h)];
  const HalfEdge ghosts[4] = {base + 6, base + 9, base + 12, base + 15};
  if (found.convex) {
    if (is_inside(v[0], v[1], v[2], v[3])) { // the diagonal is b d: call b a
      const Vertex a = v[0];
      v[0] = v[1];
      v[1] = v[2];
      v[2] = v[3];
      v[3] = a;
    }
    set_corners(base, v[2], v[0], v[1]);
    set_corners(base + 3, v[3], v[0], v[2]);
    set_ghost(ghosts[0], v[0], v[1]);
    set_ghost(ghosts[1], v[1], v[2]);
    set_ghost(ghosts[2], v[2], v[3]);
    set_ghost(ghosts[3], v[3], v[0]);
    hull = hull_of(ghosts, 4);
  } else {
    set_corners(base, v[3], v[0], v[1]);
    set_corners(base + 3, v[3], v[1], v[2]);
    set_corners(base + 6, v[3], v[2], v[0]);
    set_ghost(ghosts[1], v[0], v[1]);
    set_ghost(ghosts[2], v[1], v[2]);
    set_ghost(ghosts[3], v[2], v[0]);
    hull = hull_of(ghosts + 1, 3);
  }
  return true;
}

} // namespace dovetail::divide_and_conquer
