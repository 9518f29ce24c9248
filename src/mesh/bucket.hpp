/// Triangulates the sites of one leaf of the first cuts, a few thousand, near each other in memory. Private
/// to divide and conquer.
#pragma once

#include "sphere.hpp"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace dovetail::divide_and_conquer {

/// Coordinates of a bucket under the vertex numbers of the whole. One more, the last, is the point at
/// infinity. The address is of a vertex 0 that is not there: one subtraction less in every look-up.
struct NearSites {
  std::uintptr_t address;
  NearSites() = default;
  NearSites(const Point *points, Vertex first)
      : address(reinterpret_cast<std::uintptr_t>(points) -
                static_cast<std::uintptr_t>(first) * sizeof(Point)) {}
  Point operator[](Vertex v) const {
    return *reinterpret_cast<const Point *>(address + static_cast<std::uintptr_t>(v) * sizeof(Point));
  }
};

/// Works on one bucket after another in the same memory.
class BucketKernel {
public:
  BucketKernel(std::span<const Point> sites, std::span<LocalIndex> order, LocalIndex *corner,
               LocalIndex *twin, double guard)
      : sites_(sites), order_(order), corner_(corner), twin_(twin), guard_(guard) {}

  /// Triangulates the sites order[first] .. order[first + count - 1], which it puts into an order of its own;
  /// count >= 2. Their point at infinity is `far_ghost` afterwards.
  Hull triangulate(Vertex first, Vertex count, Vertex far_ghost);

private:
  struct Numbered {
    Point point;
    LocalIndex index;
  };

  struct Box {
    Point low;
    Point high;
    void add(Point p) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    unsigned longer_side() const { return high.y - low.y > high.x - low.x ? 1 : 0; }
  };

  /// Differences of coordinates do not overflow.
  bool fixed_point_is_safe() const { return guard_ < no_filter; }
  void gather();
  void sort_into_tiles();
  Hull conquer_tiles(std::size_t tile, unsigned level);
  Hull conquer_few(Vertex first, Vertex count);
  template <std::size_t lanes>
  bool sort_by_rank(Vertex first, Vertex count, Vertex half, unsigned axis, double low, double high);
  Hull conquer_by_median(Vertex first, Vertex count);
  Box box_of(Vertex first, Vertex count);

  Point *point(Vertex v) { return points_.data() + (v - first_); }
  LocalIndex *index(Vertex v) { return order_.data() + v; }

  std::span<const Point> sites_;
  std::span<LocalIndex> order_;
  LocalIndex *corner_;
  LocalIndex *twin_;
  double guard_;

  Vertex first_ = 0;
  Vertex count_ = 0;
  Sphere<NearSites> sphere_{};
  Box box_{};
  std::vector<Point> points_;           ///< of the bucket, in cut order, and the point at infinity
  std::vector<Numbered> scratch_;       ///< the bucket before it is sorted
  std::vector<std::uint32_t> key_;      ///< tiles of the sites before they are sorted
  std::vector<LocalIndex> tile_start_;  ///< first vertex of each tile, and the end
  unsigned bits_ = 0;                   ///< there are 2^bits tiles
  std::vector<unsigned> axis_of_level_; ///< of the cuts between tiles
};

} // namespace dovetail::divide_and_conquer
