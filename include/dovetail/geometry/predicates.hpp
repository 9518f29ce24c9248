/// The predicates that are the only source of topology. Local; thread-safe; no state.
///
/// Each is right for every finite double: a floating-point filter decides what it can, exact integer
/// arithmetic on the aligned mantissas decides the rest, so neither overflow nor underflow can spoil a sign.
/// The filter is inline and costs a few nanoseconds; the exact stage is out of line. The filters are those of
/// Shewchuk (Adaptive precision floating-point arithmetic and fast robust geometric predicates, 1997), first
/// stage, with a guard against underflow. They need IEEE rounding to nearest and no contraction of products
/// and sums (-ffp-contract=off).
#pragma once

#include "dovetail/base/sign.hpp"
#include "dovetail/base/types.hpp"

#include <cmath>

namespace dovetail {

/// The line x = m+ (Axis::x) or y = m+ (Axis::y): `position` plus an infinitesimal.
struct SplitLine {
  double position;
  Axis axis;
};

/// Positive if a, b, c turn counter-clockwise, zero if they are collinear.
Sign orientation(Point a, Point b, Point c);

/// Positive if d lies inside the circle of the counter-clockwise a, b, c. Never zero for four distinct
/// points: ties are settled by the symbolic perturbation of the lifted height in which the lexicographically
/// larger site dominates (include/dovetail/README.md). a, b, c must not be collinear.
Sign in_circle(Point a, Point b, Point c, Point d);

/// Turn of a, b, c after projection to (along, (across - m)^2 + along^2): the lower hull of the projected
/// sites is the split path. Positive is a left turn (the hull is convex at b). Zero only for collinear a, b,
/// c.
Sign hull_turn(Point a, Point b, Point c, SplitLine line);

/// The same polynomial for pruning, before the line is moved to m+: sign of D(a, b, c, m).
Sign hull_turn_unperturbed(Point a, Point b, Point c, SplitLine line);

/// True if the circumcenter of the (not collinear) a, b, c, in either orientation, has across <= m.
bool circumcenter_is_left(Point a, Point b, Point c, SplitLine line);

/// True if the line m+ is nearer to a than to b. Distances from m decide; of two that are equal, the site of
/// greater `across` is nearer, and sites of equal `across` are not nearer than each other.
bool nearer(Point a, Point b, SplitLine line);

/// True if the corner of the split lines x = corner.x+ and y = corner.y+ is nearer to a than to b, which are
/// distinct. Of two at equal distances the one of greater x is nearer, of equal x that of greater y: the
/// infinitesimal of y is smaller than that of x.
bool nearer(Point a, Point b, Point corner);

/// The same seven without the filters: what certification uses, so that a fault in a filter cannot hide
/// itself.
namespace exact {
Sign orientation(Point a, Point b, Point c);
Sign in_circle(Point a, Point b, Point c, Point d);
Sign hull_turn(Point a, Point b, Point c, SplitLine line);
Sign hull_turn_unperturbed(Point a, Point b, Point c, SplitLine line);
bool circumcenter_is_left(Point a, Point b, Point c, SplitLine line);
bool nearer(Point a, Point b, SplitLine line);
bool nearer(Point a, Point b, Point corner);
} // namespace exact

/// Filters give the sign of a determinant, or zero for "not decided": a filter never certifies a zero.
///
/// Let u = 2^-53. Every filter compares the rounded determinant with (constant * u) * permanent + guard,
/// where the permanent is the determinant with every term made positive.
///  - Rounding. The constant bounds the accumulated relative error, that of the differences, of the permanent
///    and of the bound itself included.
///  - Overflow. Whatever becomes infinite or NaN in the determinant does so in the permanent, which has the
///    same terms; a comparison with an infinite or NaN bound is false.
///  - Underflow. Sums are exact where they underflow; a product adds at most 2^-1075, scaled afterwards by
///    the factors it meets. The guard is 2^-960 times (1 + those factors), which is more by a factor of 2^100
///    and is itself never subnormal.
namespace filter {

inline constexpr double unit_roundoff = 0x1p-53;
inline constexpr double underflow_guard = 0x1p-960;

inline Sign decide(double determinant, double bound) {
  return determinant > bound ? Sign::positive : -determinant > bound ? Sign::negative : Sign::zero;
}

/// Constant 3 + 16 u: Shewchuk 1997, ccwerrboundA.
inline Sign orientation(Point a, Point b, Point c) {
  const double left = (a.x - c.x) * (b.y - c.y);
  const double right = (a.y - c.y) * (b.x - c.x);
  constexpr double constant = (3.0 + 16.0 * unit_roundoff) * unit_roundoff;
  return decide(left - right, constant * (std::fabs(left) + std::fabs(right)) + underflow_guard);
}

/// Constant 10 + 96 u: Shewchuk 1997, iccerrboundA. A product lost in a minor meets one lift, one lost in a
/// lift meets a minor, which is at most half the sum of the other two lifts.
inline Sign in_circle(Point a, Point b, Point c, Point d) {
  const double ax = a.x - d.x, ay = a.y - d.y;
  const double bx = b.x - d.x, by = b.y - d.y;
  const double cx = c.x - d.x, cy = c.y - d.y;
  const double bxcy = bx * cy, cxby = cx * by;
  const double cxay = cx * ay, axcy = ax * cy;
  const double axby = ax * by, bxay = bx * ay;
  const double a_lift = ax * ax + ay * ay;
  const double b_lift = bx * bx + by * by;
  const double c_lift = cx * cx + cy * cy;
  const double determinant = a_lift * (bxcy - cxby) + b_lift * (cxay - axcy) + c_lift * (axby - bxay);
  const double permanent = (std::fabs(bxcy) + std::fabs(cxby)) * a_lift +
                           (std::fabs(cxay) + std::fabs(axcy)) * b_lift +
                           (std::fabs(axby) + std::fabs(bxay)) * c_lift;
  constexpr double constant = (10.0 + 96.0 * unit_roundoff) * unit_roundoff;
  const double guard = underflow_guard * ((a_lift + b_lift) + (c_lift + 1.0));
  return decide(determinant, constant * permanent + guard);
}

/// D does not change when everything moves along the line, so a becomes the origin of `along`:
///   D = B (C^2 + Xc Sc) - C (B^2 + Xb Sb),  B = along b - along a,  C = along c - along a,
///   Xs = across s - across a,  Ss = (across s - m) + (across a - m).
/// Relative to the permanent, S has the error 2u (3 roundings, of which the last is the sum's), X S then 5u,
/// the square 3u, their sum 6u, the product with B 8u and the difference 9u. 10 leaves room for the higher
/// orders of u and for the rounding of the bound.
inline Sign hull_turn(Point a, Point b, Point c, SplitLine line) {
  const double m = line.position;
  const double a_across = across(a, line.axis), b_across = across(b, line.axis),
               c_across = across(c, line.axis);
  const double B = along(b, line.axis) - along(a, line.axis);
  const double C = along(c, line.axis) - along(a, line.axis);
  const double Xb = b_across - a_across, Xc = c_across - a_across;
  const double from_a = a_across - m, from_b = b_across - m, from_c = c_across - m;
  const double BB = B * B, CC = C * C;
  const double determinant = B * (CC + Xc * (from_c + from_a)) - C * (BB + Xb * (from_b + from_a));
  const double permanent = std::fabs(B) * (CC + std::fabs(Xc) * (std::fabs(from_c) + std::fabs(from_a))) +
                           std::fabs(C) * (BB + std::fabs(Xb) * (std::fabs(from_b) + std::fabs(from_a)));
  constexpr double constant = 10.0 * unit_roundoff;
  const double guard = underflow_guard * (std::fabs(B) + std::fabs(C) + 1.0);
  return decide(determinant, constant * permanent + guard);
}

/// The square of the distance of a less that of b, as the sum over both coordinates of difference times sum
/// (positions seen from the corner). Relative to the permanent, the difference has the error u, the sum 2u,
/// their product 4u, the sum of both 5u; 6 leaves room for the rest.
inline Sign farther(Point a, Point b, Point corner) {
  const double ax = a.x - corner.x, ay = a.y - corner.y, bx = b.x - corner.x, by = b.y - corner.y;
  const double dx = a.x - b.x, dy = a.y - b.y;
  const double permanent =
      std::fabs(dx) * (std::fabs(ax) + std::fabs(bx)) + std::fabs(dy) * (std::fabs(ay) + std::fabs(by));
  constexpr double constant = 6.0 * unit_roundoff;
  return decide(dx * (ax + bx) + dy * (ay + by), constant * permanent + underflow_guard);
}

} // namespace filter

inline Sign orientation(Point a, Point b, Point c) {
  const Sign sign = filter::orientation(a, b, c);
  return sign != Sign::zero ? sign : exact::orientation(a, b, c);
}

inline Sign in_circle(Point a, Point b, Point c, Point d) {
  const Sign sign = filter::in_circle(a, b, c, d);
  return sign != Sign::zero ? sign : exact::in_circle(a, b, c, d);
}

inline Sign hull_turn(Point a, Point b, Point c, SplitLine line) {
  const Sign sign = filter::hull_turn(a, b, c, line);
  return sign != Sign::zero ? sign : exact::hull_turn(a, b, c, line);
}

inline Sign hull_turn_unperturbed(Point a, Point b, Point c, SplitLine line) {
  const Sign sign = filter::hull_turn(a, b, c, line);
  return sign != Sign::zero ? sign : exact::hull_turn_unperturbed(a, b, c, line);
}

inline bool circumcenter_is_left(Point a, Point b, Point c, SplitLine line) {
  const Sign side = filter::hull_turn(a, b, c, line);
  const Sign turn = filter::orientation(a, b, c);
  if (side == Sign::zero || turn == Sign::zero)
    return exact::circumcenter_is_left(a, b, c, line);
  // Exchanging the axes mirrors the plane, and with it the orientation.
  return (side == turn) == (line.axis == Axis::x);
}

inline bool nearer(Point a, Point b, SplitLine line) {
  // Rounding is monotone, so distances that differ once rounded differ the same way before.
  const double of_a = std::fabs(across(a, line.axis) - line.position);
  const double of_b = std::fabs(across(b, line.axis) - line.position);
  return of_a != of_b ? of_a < of_b : exact::nearer(a, b, line);
}

inline bool nearer(Point a, Point b, Point corner) {
  const Sign sign = filter::farther(a, b, corner);
  return sign != Sign::zero ? sign == Sign::negative : exact::nearer(a, b, corner);
}

} // namespace dovetail
