/// The bottom of the split-path recursion: triangulating a border without interior sites. Private to mesh.
#pragma once

#include "dovetail/mesh/triangulation.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace dovetail {

/// Triangulates what closed walks along Delaunay edges enclose, when no site lies inside.
class BorderTriangulation {
public:
  BorderTriangulation(std::span<const Point> sites, std::vector<LocalIndex> &corners)
      : sites_(sites), corners_(corners), place_(sites.size(), none) {}

  /// On entry: a walk of vertices, counter-clockwise around what it encloses, its end being next to its
  /// beginning; pinched walks meet a vertex or an edge again, and never enclose anything twice. Appends the
  /// corners of all triangles inside. O(k) a triangle at worst, for a walk of k vertices; nearly all walks
  /// are short.
  void solve(std::span<const LocalIndex> walk);

private:
  void solve_simple(std::vector<LocalIndex> polygon);
  std::size_t apex(std::span<const LocalIndex> polygon) const;
  std::uint64_t random();

  std::span<const Point> sites_;
  std::vector<LocalIndex> &corners_;
  std::vector<LocalIndex> place_; ///< of a vertex on the walk that is open; `none` elsewhere
  std::vector<LocalIndex> open_;
  std::uint64_t random_state_ = 0;
};

} // namespace dovetail
