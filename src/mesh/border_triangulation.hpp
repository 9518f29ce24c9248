/// The bottom of the split-path recursion: triangulating a border without interior sites. Private to mesh.
#pragma once

#include "dovetail/mesh/triangulation.hpp"
#include "polygon_triangulation.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace dovetail {

/// Triangulates what closed walks along Delaunay edges enclose, when no site lies inside.
class BorderTriangulation {
public:
  BorderTriangulation(std::span<const Point> sites, std::vector<LocalIndex> &corners)
      : sites_(sites), corners_(corners), long_(sites), place_(sites.size(), none) {}

  /// On entry: a walk of vertices, counter-clockwise around what it encloses, its end being next to its
  /// beginning; pinched walks meet a vertex or an edge again, and never enclose anything twice. Appends the
  /// corners of all triangles inside. Expected O(k) for a walk of k vertices around convex polygons, and
  /// O(k log k) around others.
  void solve(std::span<const LocalIndex> walk);

private:
  void solve_simple(std::span<const LocalIndex> polygon);
  std::size_t apex(std::span<const LocalIndex> polygon) const;

  std::span<const Point> sites_;
  std::vector<LocalIndex> &corners_;
  PolygonTriangulation long_;
  std::vector<LocalIndex> place_; ///< of a vertex on the walk that is open; `none` elsewhere
  std::vector<LocalIndex> open_;
};

} // namespace dovetail
