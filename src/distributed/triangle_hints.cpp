#include "triangle_hints.hpp"

#include <algorithm>
#include <cmath>

namespace dovetail {

TriangleHints::TriangleHints(std::span<const Point> vertices, const Triangulation &mesh,
                             std::span<const Point> points) {
  constexpr std::size_t samples_of_a_point = 8, cells_of_a_point = 4;
  side_ = static_cast<std::size_t>(std::sqrt(static_cast<double>(cells_of_a_point * points.size()))) + 1;
  cells_.assign(side_ * side_, none);
  if (points.empty())
    return;
  const auto [left, right] = std::ranges::minmax(points, {}, &Point::x);
  const auto [lowest, highest] = std::ranges::minmax(points, {}, &Point::y);
  low_ = {left.x, lowest.y};
  const auto side = static_cast<double>(side_);
  per_x_ = side / (right.x - left.x);
  per_y_ = side / (highest.y - lowest.y);
  const auto is_in_box = [&](Point p) {
    return left.x <= p.x && p.x <= right.x && lowest.y <= p.y && p.y <= highest.y;
  };
  const auto count = static_cast<std::size_t>(mesh.triangle_count());
  const std::size_t samples = std::min(count, samples_of_a_point * points.size());
  for (std::size_t i = 0; i < samples; ++i) {
    const std::size_t t = count * i / samples;
    if (const Point corner = vertices[static_cast<std::size_t>(mesh.corners[3 * t])]; is_in_box(corner))
      cells_[cell(corner)] = static_cast<LocalIndex>(t);
  }
}

std::size_t TriangleHints::cell(Point point) const {
  // Points in a row or far apart make these infinite or not a number, and any cell will do.
  const auto along = [&](double distance, double per_unit) {
    const double cells = distance * per_unit;
    return cells > 0 ? std::min(side_ - 1, static_cast<std::size_t>(std::min(cells, 1e9))) : 0;
  };
  return along(point.x - low_.x, per_x_) * side_ + along(point.y - low_.y, per_y_);
}

} // namespace dovetail
