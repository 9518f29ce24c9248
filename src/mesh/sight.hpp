/// How a site sees the base of a merge: the filter of divide and conquer.
///
/// Take the plane as complex numbers. For a base l -> r and a site p above it let
///
///     z(p) = conj(p - l) (p - r) = |p - l| |p - r| (cos s + i sin s),
///
/// where s is the angle under which p sees the base. Its imaginary part is the orientation determinant of l,
/// r, p. Of two sites above the base, the one that sees it under the larger angle lies inside the circle of
/// the other, so the in-circle determinant is that of a 2 x 2 matrix:
///
///     in_circle(l, r, p, q) = Re z(p) Im z(q) - Re z(q) Im z(p)      (for every q, above or below)
///
/// A merge asks up to three such questions about four sites and one base; each site is looked at once, with
/// ten operations, and each question then costs three. The bound comes as cheaply. Let u = 2^-53 and
/// |z|_1 = |Re z| + |Im z| >= |p - l| |p - r|. The differences have the relative error u, so each of the four
/// products has 3u and each part of z is wrong by at most 4u |p - l| |p - r| <= 4u |z|_1 (higher orders of u
/// aside). A product of two such parts is then wrong by at most 9u, their difference by
/// 19u |z(p)|_1 |z(q)|_1; the constants 8u and 32u below leave room for the higher orders and for computing
/// the bounds from rounded parts.
///
/// Products that underflow lose at most 2^-1074 each, which the other factor scales: with coordinates at most
/// 2^200 every |z|_1 is under 2^404, so a guard of 2^-600 covers it. Larger coordinates get an infinite
/// guard, and the general predicates decide everything.
#pragma once

#include "dovetail/base/types.hpp"

#include <cmath>
#include <limits>

namespace dovetail::divide_and_conquer {

struct Sight {
  double re;
  double im;
  double size() const { return std::fabs(re) + std::fabs(im); }
};

inline Sight look(Point p, Point l, Point r) {
  const double xl = p.x - l.x, yl = p.y - l.y;
  const double xr = p.x - r.x, yr = p.y - r.y;
  return {xl * xr + yl * yr, xl * yr - yl * xr};
}

inline constexpr double greatest_filtered_coordinate = 0x1p200;
inline constexpr double sight_guard = 0x1p-600;
inline constexpr double no_filter = std::numeric_limits<double>::infinity();

/// Positive only if p is certainly above the base, negative only if certainly below.
inline double height_bound(Sight p, double guard) { return 0x1p-50 * p.size() + guard; }
inline double circle_bound(Sight p, Sight q, double guard) { return 0x1p-48 * (p.size() * q.size()) + guard; }
inline double circle_determinant(Sight p, Sight q) { return p.re * q.im - q.re * p.im; }

} // namespace dovetail::divide_and_conquer
