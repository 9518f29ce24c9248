/// The words every part of Dovetail shares: indices, points, axes, orders.
#pragma once

#include <cstdint>
#include <tuple>

namespace dovetail {

/// Index into the arrays of one slab (vertices, triangles, 3 * triangle + corner). Checked where it is made.
using LocalIndex = std::int32_t;
/// Number or count of anything in the whole data set.
using GlobalIndex = std::int64_t;

/// "There is none": beyond the hull, not found.
inline constexpr LocalIndex none = -1;

/// A position in the plane. Coordinates are finite, and -0.0 has been made 0.0 on reading.
struct Point {
  double x;
  double y;
  friend constexpr bool operator==(const Point &, const Point &) = default;
};

/// The lexicographic order (x, then y) by which ties of in_circle are broken, whatever the axis of the cuts.
constexpr bool lexicographically_less(Point a, Point b) { return a.x < b.x || (a.x == b.x && a.y < b.y); }

/// The coordinate that slabs cut: slabs are intervals of it, and split lines are perpendicular to it.
enum class Axis : std::uint8_t { x, y };

/// The coordinate across the split lines (the one that is cut).
constexpr double across(Point p, Axis axis) { return axis == Axis::x ? p.x : p.y; }
/// The coordinate along the split lines (the one by which paths ascend).
constexpr double along(Point p, Axis axis) { return axis == Axis::x ? p.y : p.x; }

/// The total order of sites: (x, y) for cuts along x, (y, x) for cuts along y.
struct TotalOrder {
  Axis axis = Axis::x;
  constexpr bool operator()(Point a, Point b) const {
    return across(a, axis) < across(b, axis) ||
           (across(a, axis) == across(b, axis) && along(a, axis) < along(b, axis));
  }
};

} // namespace dovetail
