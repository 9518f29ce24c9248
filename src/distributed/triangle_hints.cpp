#include "triangle_hints.hpp"

#include <algorithm>
#include <cmath>

namespace dovetail {

TriangleHints::TriangleHints(std::span<const Point> vertices, const Triangulation &mesh,
                             std::span<const Point> points) {
  // A walk takes sqrt(triangles / samples) steps, each of which waits for the last, so it costs several times
  // what a sample does: walks and samples together cost least at about this number of samples.
  const auto triangles = static_cast<double>(mesh.triangle_count()),
             sought = static_cast<double>(points.size());
  const double samples = std::min(triangles, std::cbrt(8 * sought * sought * triangles));
  constexpr double samples_of_a_cell = 2;
  side_ = static_cast<std::size_t>(std::sqrt(samples / samples_of_a_cell)) + 1;
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
  for (double at = 0; at < triangles; at += triangles / samples) {
    const auto t = static_cast<std::size_t>(at);
    if (const Point corner = vertices[static_cast<std::size_t>(mesh.corners[3 * t])]; is_in_box(corner))
      cells_[cell(corner)] = static_cast<LocalIndex>(t);
  }
  // What the sample has missed is near to what it has next to it.
  for (std::size_t c = 1; c < cells_.size(); ++c)
    if (cells_[c] == none)
      cells_[c] = cells_[c - 1];
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
