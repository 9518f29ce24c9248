/// Where walks to many points in one mesh are best begun. Private to distributed. Local.
#pragma once

#include "dovetail/mesh/triangulation.hpp"

#include <span>
#include <vector>

namespace dovetail {

/// A sample of a mesh's triangles on a grid, as large as it pays for the points that will be asked about.
class TriangleHints {
public:
  /// A grid over the box of `points`. For n points and t triangles it looks at 2 (n^2 t)^(1/3) triangles, and
  /// at no more than there are.
  TriangleHints(std::span<const Point> vertices, const Triangulation &mesh, std::span<const Point> points);

  /// A triangle of the sample in the cell of one of the points, or in the last cell before it that has any;
  /// `none` where no cell up to there has. Those that have been changed since may be elsewhere.
  LocalIndex near(Point point) const { return cells_[cell(point)]; }

private:
  std::size_t cell(Point point) const;

  Point low_{0, 0};
  double per_x_ = 0, per_y_ = 0; ///< cells in a unit of length
  std::size_t side_ = 1;         ///< of the grid
  std::vector<LocalIndex> cells_;
};

} // namespace dovetail
