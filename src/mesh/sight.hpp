/// How a site sees the base of a merge: the filter of divide and conquer. Private to it.
///
/// Take the plane as complex numbers. For a base l -> r and a site p let
///
///     z(p) = conj(p - l) (p - r) = |p - l| |p - r| (cos s + i sin s),
///
/// where s is the angle under which p sees the base. Its imaginary part is the orientation determinant of l,
/// r, p. Of two sites above the base, the one that sees it under the larger angle lies inside the circle of
/// the other; so the in-circle determinant is that of a 2 x 2 matrix,
///
///     in_circle(l, r, p, q) = Re z(p) Im z(q) - Re z(q) Im z(p)      (for every q, above or below).
///
/// A step of a merge asks up to three such questions about four sites and one base. Each site is looked at
/// once, with ten operations, and then every question costs three; the general predicate would take about
/// thirty for each. Both sides of the seam are looked at together, in the two lanes of a vector.
///
/// Bounds. Let u = 2^-53. The differences have the relative error u, so each of the four products has 3u and
/// each part of z is wrong by at most 4u |p - l| |p - r| (higher orders of u aside). A product of two such
/// parts is then wrong by at most 9u |z(p)| |z(q)|, the determinant by 20u |z(p)| |z(q)|. Within a part of
/// diameter d every |z| is at most d^2: 8u d^2 and 32u d^4 bound what happens in a whole merge, and leave
/// room for higher orders and for the rounding of d. Long seams are fine at the bottom, where nearly all
/// steps are; where they decide too little, the same with |Re z| + |Im z| >= |z| for d^2 decides nearly all.
///
/// Underflow: a product loses at most 2^-1075, scaled afterwards by the other factor. With coordinates up to
/// 2^200 every |z| is under 2^404, so a guard of 2^-600 covers it. Larger coordinates get an infinite guard,
/// and the general predicates decide everything.
#pragma once

#include "dovetail/base/types.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace dovetail::divide_and_conquer {

inline constexpr double greatest_filtered_coordinate = 0x1p200;
inline constexpr double sight_guard = 0x1p-600;
inline constexpr double no_filter = std::numeric_limits<double>::infinity();

/// Where all coordinates are multiples of a power of two, differences of sites near each other are short
/// integers, and nothing is rounded at all. With |z| <= 2^26 units^2 for every site, each product of two
/// differences is at most 2^26, each product of two parts of z at most 2^52 and the determinant, at most
/// |z(p)| |z(q)|, too: its sign is right, and a zero is a tie. Likewise an orientation alone, with |z| <=
/// 2^52 units^2. Units of at least 2^-200 keep clear of underflow, and coordinates of at most 2^40 units keep
/// differences exact, so that a |z| above a bound is never computed as one below it. On a lattice most
/// questions are ties: 1390 instructions a point in place of 2600, when exact integers settled them.
inline constexpr double exact_circle_z = 0x1p26;
inline constexpr double exact_turn_z = 0x1p52;

/// Stands in for the point at infinity: so far from all filtered coordinates that the filter certifies it
/// outside of every circle over a base, also where nothing else is rounded and the bounds are zero: then
/// Re z(p) Im z(q) < 2^26 units^2 2^602, and Re z(q) Im z(p) > 2^799 units^2 for a p that is above at all.
inline constexpr Point far_away{0x1p400, 0.0};

/// Lane 0 belongs to the left side of the seam, lane 1 to the right.
typedef double Pair __attribute__((vector_size(16)));

/// Lane by lane, of finite numbers.
inline Pair least(Pair a, Pair b) {
#ifdef __SSE2__
  return _mm_min_pd(a, b);
#else
  return Pair{a[0] < b[0] ? a[0] : b[0], a[1] < b[1] ? a[1] : b[1]};
#endif
}
inline Pair greatest(Pair a, Pair b) {
#ifdef __SSE2__
  return _mm_max_pd(a, b);
#else
  return Pair{a[0] > b[0] ? a[0] : b[0], a[1] > b[1] ? a[1] : b[1]};
#endif
}

inline Pair pair_of(Point p) { return Pair{p.x, p.y}; }

/// One bit a lane.
inline unsigned equal_lanes(Pair a, Pair b) {
#ifdef __SSE2__
  return static_cast<unsigned>(_mm_movemask_pd(_mm_cmpeq_pd(a, b)));
#else
  return (a[0] == b[0] ? 1U : 0U) | (a[1] == b[1] ? 2U : 0U);
#endif
}

/// One bit a lane: is the value at least as great as the other?
inline unsigned lanes_from(Pair value, Pair other) {
#ifdef __SSE2__
  return static_cast<unsigned>(_mm_movemask_pd(_mm_cmpge_pd(value, other)));
#else
  return (value[0] >= other[0] ? 1U : 0U) | (value[1] >= other[1] ? 2U : 0U);
#endif
}

/// One bit a lane: is it negative?
inline unsigned negative_lanes(Pair value) {
#ifdef __SSE2__
  return static_cast<unsigned>(_mm_movemask_pd(value));
#else
  return (std::signbit(value[0]) ? 1U : 0U) | (std::signbit(value[1]) ? 2U : 0U);
#endif
}

/// One bit a lane: is its absolute value above the bound? Not a number is above nothing.
inline unsigned lanes_beyond(Pair value, Pair bound) {
  return (std::fabs(value[0]) > bound[0] ? 1U : 0U) | (std::fabs(value[1]) > bound[1] ? 2U : 0U);
}

inline bool all_lanes_beyond(Pair value, Pair bound) {
#ifdef __SSE2__
  return _mm_movemask_pd(_mm_cmpgt_pd(_mm_andnot_pd(_mm_set1_pd(-0.0), value), bound)) == 3;
#else
  return lanes_beyond(value, bound) == 3;
#endif
}

/// Are all four?
inline bool all_lanes_beyond(Pair a, Pair a_bound, Pair b, Pair b_bound) {
#ifdef __SSE2__
  const __m128d sign = _mm_set1_pd(-0.0);
  return _mm_movemask_pd(_mm_and_pd(_mm_cmpgt_pd(_mm_andnot_pd(sign, a), a_bound),
                                    _mm_cmpgt_pd(_mm_andnot_pd(sign, b), b_bound))) == 3;
#else
  return (lanes_beyond(a, a_bound) & lanes_beyond(b, b_bound)) == 3;
#endif
}

template <class Number> struct SightOf {
  Number re;
  Number im;
};
using Sight = SightOf<double>;
using SightPair = SightOf<Pair>;

template <class Number>
SightOf<Number> look(Number px, Number py, Number lx, Number ly, Number rx, Number ry) {
  const Number from_lx = px - lx, from_ly = py - ly;
  const Number from_rx = px - rx, from_ry = py - ry;
  return {from_lx * from_rx + from_ly * from_ry, from_lx * from_ry - from_ly * from_rx};
}

inline Sight look(Point p, Point l, Point r) { return look(p.x, p.y, l.x, l.y, r.x, r.y); }

template <class Number> Number circle_determinant(SightOf<Number> p, SightOf<Number> q) {
  return p.re * q.im - q.re * p.im;
}

/// What a determinant must exceed to have a certain sign.
struct Bounds {
  double height;
  double circle;
};

/// What is known of all sites. As it is made, nothing: the general predicates decide everything.
struct Filter {
  double guard = no_filter;
  double exact_z = -1;          ///< no rounding where every |z| is at most this
  bool turns_are_exact = false; ///< no rounding in the orientation of any three sites

  Bounds bounds(double z, double other_z) const {
    if (std::max(z, other_z) <= exact_z)
      return {0, 0};
    return {0x1p-50 * z + guard, 0x1p-48 * (z * other_z) + guard};
  }
  bool decides() const { return guard < no_filter; }
};

} // namespace dovetail::divide_and_conquer
