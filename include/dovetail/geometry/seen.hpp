/// The filters of orientation and in_circle for many questions about one point p: sites as seen from it, each
/// looked at once. What they leave undecided goes to the predicates. Local; no state.
///
/// With a, b, ... for the differences to p, and L for their squares: orientation(a, b, p) is the sign of
/// a x b, and for p on the left of an edge a b of which w is the apex beyond,
///
///     in_circle(b, a, w, p) = sign of  L_b (a x w) + L_a (w x b) - L_w (a x b),
///
/// the same determinant as in filter::in_circle, added up in the same way. Here its permanent is not
/// computed but bounded: |a1 w2| + |a2 w1| <= |a| |w| <= (L_a + L_w) / 2, likewise for the other two, which
/// together gives
///
///     permanent <= L_a L_b + L_b L_w + L_w L_a.
///
/// The constant of filter::in_circle is 10 u with terms of higher order; 11 u leaves room for those, and for
/// the rounding of the lifts (2 u each) and of the bound. Overflow and underflow are as there.
#pragma once

#include "dovetail/geometry/predicates.hpp"

namespace dovetail {

struct Seen {
  double x;
  double y;
  double lift;
};

inline Seen see(Point site, Point from) {
  const double x = site.x - from.x, y = site.y - from.y;
  return {x, y, x * x + y * y};
}

inline double cross(const Seen &a, const Seen &b) { return a.x * b.y - a.y * b.x; }

namespace filter {

/// As filter::orientation of a, b and the point they are seen from.
inline Sign turn(const Seen &a, const Seen &b) {
  const double left = a.x * b.y, right = a.y * b.x;
  constexpr double constant = (3.0 + 16.0 * unit_roundoff) * unit_roundoff;
  return decide(left - right, constant * (std::fabs(left) + std::fabs(right)) + underflow_guard);
}

/// Is the point inside the circle of b, a, w? Zero if not decided. The crosses are those of `cross`.
inline Sign in_circle(const Seen &a, const Seen &b, const Seen &w, double cross_ab, double cross_aw,
                      double cross_wb) {
  const double determinant = b.lift * cross_aw + a.lift * cross_wb - w.lift * cross_ab;
  const double lifts = a.lift + b.lift;
  const double permanent = w.lift * lifts + a.lift * b.lift;
  constexpr double constant = 11.0 * unit_roundoff;
  return decide(determinant, constant * permanent + underflow_guard * (lifts + (w.lift + 1.0)));
}

} // namespace filter
} // namespace dovetail
