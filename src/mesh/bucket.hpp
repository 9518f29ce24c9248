/// Triangulates the sites of one leaf of the first cuts, a few thousand, near each other in memory. Private
/// to divide and conquer.
///
/// There is no comparison sort, and all that is touched fits the second cache. Cuts are found in three ways,
/// the cheapest that works:
///   - between tiles: one counting sort puts the sites into the tiles of a grid, about six in each, and every
///   cut
///     down to 16 sites is then a look-up. 36 instructions a point. A crowded tile gets a grid of its own,
///     unless it has nearly all sites of this grid: kuzmin, clusters and line went from 1490-1650
///     instructions and 13 mispredictions a point, with medians there, to 1120-1270 and 7;
///   - by rank, for up to 16 sites: how many precede each is counted in vectors without a branch, and the
///     pieces have four sites, which smallest_parts.hpp solves directly;
///   - by an exact median: always works, and is left for ties, for coordinates whose differences overflow and
///   for
///     a single site on one side of a cut (a part has at least two).
#pragma once

#include "median_tree.hpp"
#include "sphere.hpp"

#include <array>
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
    const std::uintptr_t site = address + static_cast<std::uintptr_t>(v) * sizeof(Point);
    return *reinterpret_cast<const Point *>(site); // NOLINT(performance-no-int-to-ptr)
  }
};

/// Both coordinates at once, in the lanes of a vector.
struct Box {
  Pair low;
  Pair high;

  explicit Box(Point p) : low{p.x, p.y}, high{p.x, p.y} {}
  void add(Point p) {
    const Pair both{p.x, p.y};
    low = least(low, both);
    high = greatest(high, both);
  }
  unsigned longer_side() const { return high[1] - low[1] > high[0] - low[0] ? 1 : 0; }
};

/// Works on one bucket after another in the same memory.
class BucketKernel {
public:
  BucketKernel(LocalIndex *corner, LocalIndex *twin, const Filter &filter)
      : corner_(corner), twin_(twin), filter_(filter) {}

  /// Triangulates the sites that wait in the rooms `first` .. `first + count - 1` of the corners (see
  /// NumberedSite); count >= 2. Afterwards the corners of their triangles are there, as numbers of sites, and
  /// the point at infinity is `far_ghost`.
  Hull triangulate(Vertex first, Vertex count, LocalIndex far_ghost);

private:
  /// Tiles of a grid over some of the sites, numbered so that halving a range of them is a cut across the
  /// longer side.
  struct Grid {
    std::size_t start;  ///< of its tiles in tile_start_
    unsigned bits;      ///< there are 2^bits tiles
    std::uint64_t axes; ///< bit i: the axis of the cuts at level i
    Vertex sites;

    unsigned axis(unsigned level) const { return static_cast<unsigned>(axes >> level & 1); }
  };

  /// Differences of coordinates do not overflow.
  bool fixed_point_is_safe() const { return filter_.decides(); }
  Hull conquer(Vertex first, Vertex count);
  Hull conquer_in_grid(Vertex first, Vertex count);
  Hull conquer_unsorted(const void *sites, Vertex first, Vertex count, const Box &box);
  Grid sort_into_tiles(const void *sites, Vertex first, Vertex count, const Box &box);
  Hull conquer_tiles(const Grid &grid, std::size_t tile, unsigned level);
  Hull conquer_few(Vertex first, Vertex count);
  template <std::size_t lanes>
  bool sort_by_rank(Vertex first, Vertex count, Vertex half, unsigned axis, double low, double high);
  Hull conquer_by_median(Vertex first, Vertex count);
  void to_scratch(Vertex first, Vertex count);
  void take(const void *sites, Vertex first, Vertex count);
  Box box_of(Vertex first, Vertex count);

  Point *point(Vertex v) { return points_.data() + (v - first_); }
  LocalIndex *number(Vertex v) { return numbers_.data() + (v - first_); }

  LocalIndex *corner_;
  LocalIndex *twin_;
  Filter filter_;

  Vertex first_ = 0;
  Sphere<NearSites> sphere_{};
  std::vector<Point> points_;          ///< of the bucket, in cut order, and the point at infinity
  std::vector<LocalIndex> numbers_;    ///< likewise
  std::vector<NumberedSite> scratch_;  ///< sites before they are sorted
  std::vector<std::uint32_t> key_;     ///< and their tiles
  std::vector<LocalIndex> tile_start_; ///< of the grids at work, one within a tile of another: the first
                                       ///< vertex of each tile, and the end
  std::array<std::vector<std::uint32_t>, 2> spread_; ///< [axis][tile along the axis]: bits of a tile's number
};

} // namespace dovetail::divide_and_conquer
