/// Rounded constructions: places for new vertices. Local; no decision about topology rests on them.
///
/// Positions are differences from one of the points until the last addition, so that coordinates with a large
/// common offset (UTM) lose no more than the rounding of the result.
#pragma once

#include "dovetail/base/types.hpp"

#include <cmath>

namespace dovetail {

/// A difference of positions.
struct Displacement {
  double x;
  double y;
};

constexpr Displacement operator-(Point a, Point b) { return {a.x - b.x, a.y - b.y}; }
constexpr Point operator+(Point a, Displacement d) { return {a.x + d.x, a.y + d.y}; }
constexpr Displacement operator*(double factor, Displacement d) { return {factor * d.x, factor * d.y}; }
constexpr double dot(Displacement a, Displacement b) { return a.x * b.x + a.y * b.y; }
constexpr double cross(Displacement a, Displacement b) { return a.x * b.y - a.y * b.x; }
constexpr double squared_length(Displacement d) { return dot(d, d); }
constexpr double squared_distance(Point a, Point b) { return squared_length(a - b); }
inline double distance(Point a, Point b) { return std::sqrt(squared_distance(a, b)); }

/// Twice the area of a, b, c; positive if they are counter-clockwise.
constexpr double doubled_area(Point a, Point b, Point c) { return cross(b - a, c - a); }

/// From a to the circumcenter of a, b, c, which must not be collinear once rounded.
constexpr Displacement to_circumcenter(Point a, Point b, Point c) {
  const Displacement ab = b - a, ac = c - a;
  const double ab2 = squared_length(ab), ac2 = squared_length(ac);
  const double factor = 0.5 / cross(ab, ac);
  return {factor * (ac.y * ab2 - ab.y * ac2), factor * (ab.x * ac2 - ac.x * ab2)};
}

constexpr Point circumcenter(Point a, Point b, Point c) { return a + to_circumcenter(a, b, c); }

/// The point on the bisector of ab, on its left, that sees ab under an angle of which `reach` is half the
/// cotangent of the half; or the circumcenter of the counter-clockwise a, b, c, if it is nearer (Ungor,
/// Off-centers, 2004). ab is to be the shortest side.
constexpr Point off_center(Point a, Point b, Point c, double reach) {
  const Displacement ab = b - a;
  const Displacement far{0.5 * ab.x - reach * ab.y, 0.5 * ab.y + reach * ab.x};
  const Displacement center = to_circumcenter(a, b, c);
  return a + (squared_length(far) < squared_length(center) ? far : center);
}

constexpr Point barycentre(Point a, Point b, Point c) {
  const Displacement ab = b - a, ac = c - a;
  return a + Displacement{(ab.x + ac.x) / 3, (ab.y + ac.y) / 3};
}

/// The point that divides ab at this fraction of its length from a.
constexpr Point between(Point a, Point b, double fraction) { return a + fraction * (b - a); }

} // namespace dovetail
