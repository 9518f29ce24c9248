/// The filters of orientation and in_circle for many questions about one point p: sites as seen from it, each
/// looked at once, and two questions answered at a time. What they leave undecided goes to the predicates.
/// Local; no state.
///
/// With a, b, ... for the differences to p, and L for their squares: orientation(a, b, p) is the sign of
/// a x b, and for p on the left of an edge a b of which w is the apex beyond,
///
///     in_circle(b, a, w, p) = sign of  L_b (a x w) + L_a (w x b) - L_w (a x b),
///
/// the same determinant as in filter::in_circle, added up in the same way. Here its permanent is not
/// computed but bounded: |a1 w2| + |a2 w1| <= |a| |w| <= (L_a + L_w) / 2, likewise for the other two, which
/// together gives, with S = L_a + L_b + L_w,
///
///     permanent <= L_a L_b + L_b L_w + L_w L_a <= S^2 / 3,
///
/// the latter because the sum of the squares of (L_a - L_b), (L_b - L_w) and (L_w - L_a) is not negative.
/// The constant of filter::in_circle is 10 u with terms of higher order; 4 u S^2 is 12 u S^2 / 3, which
/// leaves room for those, for the rounding of the lifts (2 u each) and for that of the bound.
///
/// Overflow. Every product in the determinant is at most S or S^2, and S^2 is multiplied by u only when it is
/// there: what overflows in the determinant has done so in the bound. Underflow is as there: the guard is g
/// (1 + S), here as 4 u (G + G S) with G = g / (4 u).
#pragma once

#include "dovetail/geometry/predicates.hpp"

namespace dovetail {

/// Two numbers that are worked on together, by one instruction where the processor has such.
using Pair [[gnu::vector_size(16)]] = double;

inline Pair absolute(Pair v) { return Pair{std::fabs(v[0]), std::fabs(v[1])}; }

/// A site; or two, where Number is Pair: each value is that of the one and that of the other.
template <class Number> struct SeenAs {
  Number x;
  Number y;
  Number lift;
};
using Seen = SeenAs<Pair>;
using SeenAlone = SeenAs<double>;

/// The difference of a site, its x and its y.
inline Pair see(Point site, Point from) { return Pair{site.x, site.y} - Pair{from.x, from.y}; }

inline SeenAlone see_alone(Point site, Point from) {
  const double x = site.x - from.x, y = site.y - from.y;
  return {x, y, x * x + y * y};
}

inline Seen both(Pair one, Pair other) {
  const Pair x = {one[0], other[0]}, y = {one[1], other[1]};
  return {x, y, x * x + y * y};
}

/// Number I of a pair, and number I of another.
template <int I> Pair both(Pair one, Pair other) { return Pair{one[I], other[I]}; }
template <int I> Seen both(const Seen &one, const Seen &other) {
  return {both<I>(one.x, other.x), both<I>(one.y, other.y), both<I>(one.lift, other.lift)};
}

template <class Number> Number cross(const SeenAs<Number> &a, const SeenAs<Number> &b) {
  return a.x * b.y - a.y * b.x;
}

namespace filter {

/// A determinant and how wrong it may be.
template <class Number> struct BoundedAs {
  Number value;
  Number bound;
};
using Bounded = BoundedAs<Pair>;

/// As filter::orientation of a, b and the point they are seen from.
inline Bounded turn(const Seen &a, const Seen &b) {
  const Pair left = a.x * b.y, right = a.y * b.x;
  constexpr double constant = (3.0 + 16.0 * unit_roundoff) * unit_roundoff;
  return {left - right, constant * (absolute(left) + absolute(right)) + underflow_guard};
}

/// Is the point inside the circle of b, a, w? The crosses are those of `cross`.
template <class Number>
BoundedAs<Number> in_circle(const SeenAs<Number> &a, const SeenAs<Number> &b, const SeenAs<Number> &w,
                            Number cross_ab, Number cross_aw, Number cross_wb) {
  const Number lifts = a.lift + b.lift + w.lift;
  constexpr double constant = 4.0 * unit_roundoff, guard = underflow_guard / constant;
  return {b.lift * cross_aw + a.lift * cross_wb - w.lift * cross_ab,
          constant * (lifts * (lifts + guard) + guard)};
}

} // namespace filter
} // namespace dovetail
