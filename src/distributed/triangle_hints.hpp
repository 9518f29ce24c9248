/// Where walks to many points in one mesh are best begun. Private to distributed. Local.
#pragma once

#include "dovetail/mesh/triangulation.hpp"

#include <span>
#include <vector>

namespace dovetail {

/// A sample of a mesh's triangles on a grid, as large as it pays for the points that will be asked about.
class TriangleHints {
public:
  /// A grid over the box of `points`. For n points and t triangles it looks at (n^2 t)^(1/3) triangles, and
  /// at no more than there are.
  TriangleHints(std::span<const Point> vertices, const Triangulation &mesh, std::span<const Point> points);

  /// For each of some points a triangle near to it, hardly ever not the one that holds it: where a walk leads
  /// that begins in the sample and trusts to rounded arithmetic. The mesh may have changed since the sample
  /// was taken, and be broken, as long as all numbers in it are in range. A single walk waits for memory at
  /// every step; so many of them take turns, and each has the triangle that it goes to fetched in the
  /// meantime.
  std::vector<LocalIndex> near(std::span<const Point> vertices, const Triangulation &mesh,
                               std::span<const Point> points) const;

private:
  std::size_t cell(Point point) const;

  Point low_{0, 0};
  double per_x_ = 0, per_y_ = 0;  ///< cells in a unit of length
  std::size_t side_ = 1;          ///< of the grid
  std::vector<LocalIndex> cells_; ///< a triangle of the sample in each, or in the cell before it that has any
};

} // namespace dovetail
