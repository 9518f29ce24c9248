#include "bucket.hpp"

#include "merge.hpp"
#include "smallest_parts.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace dovetail::divide_and_conquer {
namespace {

constexpr Vertex few = 16;          ///< parts up to this size are cut by ranks
constexpr std::size_t per_tile = 4; ///< sites a tile of the grid, at least

/// Where to cut a small part: into pieces of four, as far as that goes, and never off a single site.
constexpr Vertex half_of(Vertex count) {
  const Vertex half = (count / 2 + 2) / 4 * 4;
  return count <= 5 ? count / 2 : count - half < 2 ? half - 2 : half;
}

/// Maps [low, low + width] monotonically to [0, limit): a scale of zero where floating point could not.
double scale_of(double low, double high, double limit) {
  const double scale = limit / (high - low) * (1 - 0x1p-40);
  return scale < 0x1p1000 ? scale : 0.0;
}

} // namespace

Box BucketKernel::box_of(Vertex first, Vertex count) {
  Box box(*point(first));
  for (Vertex v = first + 1; v < first + count; ++v)
    box.add(*point(v));
  return box;
}

Hull BucketKernel::triangulate(Vertex first, Vertex count, LocalIndex far_ghost) {
  first_ = first;
  const auto n = static_cast<std::size_t>(count);
  if (points_.size() < n + 1) {
    points_.resize(n + 1);
    numbers_.resize(n + 1);
    key_.resize(n);
  }
  points_[n] = far_away;
  numbers_[n] = far_ghost;
  sphere_ = {{points_.data(), first}, corner_, twin_, first + count, filter_};
  const LocalIndex *const sites = corner_ + 6 * first;
  Box box(NumberedSite::load(sites, 0).point);
  for (std::size_t i = 1; i < n; ++i)
    box.add(NumberedSite::load(sites, i).point);
  const Hull hull = conquer_unsorted(sites, first, count, box);
  // All is still in the cache, so here the corners get their final numbers.
  const LocalIndex *const numbers = numbers_.data();
  for (LocalIndex *six = corner_ + 6 * first; six < corner_ + 6 * (first + count) - 6; six += 6)
    for (unsigned i = 0; i < 6; ++i)
      six[i] = numbers[six[i] - first];
  return hull;
}

void BucketKernel::to_scratch(Vertex first, Vertex count) {
  const Point *const sites = point(first);
  const LocalIndex *const numbers = number(first);
  if (scratch_.size() < static_cast<std::size_t>(count))
    scratch_.resize(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
    scratch_[i] = {sites[i], numbers[i]};
}

void BucketKernel::take(const void *sites, Vertex first, Vertex count) {
  Point *const points = point(first);
  LocalIndex *const numbers = number(first);
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const NumberedSite site = NumberedSite::load(sites, i);
    points[i] = site.point;
    numbers[i] = site.number;
  }
}

/// A part of any size from two.
Hull BucketKernel::conquer(Vertex first, Vertex count) {
  return count <= few ? conquer_few(first, count) : conquer_in_grid(first, count);
}

Hull BucketKernel::conquer_in_grid(Vertex first, Vertex count) {
  if (!fixed_point_is_safe())
    return conquer_by_median(first, count);
  to_scratch(first, count);
  return conquer_unsorted(scratch_.data(), first, count, box_of(first, count));
}

/// The part whose sites lie elsewhere, in any order.
Hull BucketKernel::conquer_unsorted(const void *sites, Vertex first, Vertex count, const Box &box) {
  if (count <= few || !fixed_point_is_safe()) {
    take(sites, first, count);
    return count <= few ? conquer_few(first, count) : conquer_by_median(first, count);
  }
  const Grid grid = sort_into_tiles(sites, first, count, box);
  const Hull hull = conquer_tiles(grid, 0, 0);
  tile_start_.resize(grid.start);
  return hull;
}

/// A counting sort by the tiles of a grid. Tiles are monotone in each coordinate, so they
/// separate sites strictly.
BucketKernel::Grid BucketKernel::sort_into_tiles(const void *sites, Vertex first, Vertex count,
                                                 const Box &box) {
  const auto n = static_cast<std::size_t>(count);
  Grid grid{tile_start_.size(), static_cast<unsigned>(std::bit_width(n / per_tile)) - 1, 0, count};
  double width = box.high[0] - box.low[0];
  double height = box.high[1] - box.low[1];
  std::array<unsigned, 2> levels{};
  for (unsigned level = 0; level < grid.bits; ++level) {
    const unsigned axis = height > width ? 1 : 0;
    (axis == 0 ? width : height) /= 2;
    grid.axes |= std::uint64_t{axis} << level;
    ++levels[axis];
  }
  for (unsigned axis = 0; axis < 2; ++axis) {
    std::vector<std::uint32_t> &spread = spread_[axis];
    spread.assign(std::size_t{1} << levels[axis], 0);
    std::size_t done = spread.size(); // a bit of the number doubles what is known
    for (unsigned level = 0; level < grid.bits; ++level)
      if (grid.axis(level) == axis) {
        for (std::size_t tile = 0; tile < spread.size(); tile += done)
          spread[tile + done / 2] = spread[tile] | std::uint32_t{1} << (grid.bits - 1 - level);
        done /= 2;
      }
  }
  const double x_scale = scale_of(box.low[0], box.high[0], static_cast<double>(spread_[0].size()));
  const double y_scale = scale_of(box.low[1], box.high[1], static_cast<double>(spread_[1].size()));
  const std::size_t tiles = std::size_t{1} << grid.bits;
  tile_start_.resize(grid.start + tiles + 1, 0);
  LocalIndex *const tile_start = tile_start_.data() + grid.start;
  const std::uint32_t *const spread_x = spread_[0].data();
  const std::uint32_t *const spread_y = spread_[1].data();
  std::uint32_t *const keys = key_.data();
  for (std::size_t i = 0; i < n; ++i) {
    const Point p = NumberedSite::load(sites, i).point;
    const auto x = static_cast<std::uint32_t>(static_cast<std::int32_t>((p.x - box.low[0]) * x_scale));
    const auto y = static_cast<std::uint32_t>(static_cast<std::int32_t>((p.y - box.low[1]) * y_scale));
    const std::uint32_t key = spread_x[x] | spread_y[y];
    keys[i] = key;
    ++tile_start[key];
  }
  LocalIndex next = narrow(first);
  for (std::size_t tile = 0; tile <= tiles; ++tile) {
    const LocalIndex here = tile_start[tile];
    tile_start[tile] = next;
    next += here;
  }
  Point *const to_points = point(first);
  LocalIndex *const to_numbers = number(first);
  for (std::size_t i = 0; i < n; ++i) {
    const LocalIndex to = tile_start[keys[i]]++;
    const NumberedSite site = NumberedSite::load(sites, i);
    to_points[to - first] = site.point;
    to_numbers[to - first] = site.number;
  }
  for (std::size_t tile = tiles; tile > 0; --tile)
    tile_start[tile] = tile_start[tile - 1];
  tile_start[0] = narrow(first);
  return grid;
}

/// The 2^(bits - level) tiles that begin with `tile`. At least two sites. A tile that is still crowded gets a
/// grid of its own. One that has nearly all sites of this grid is halved first: grids within grids are then
/// O(log n) deep, however the sites are spread.
Hull BucketKernel::conquer_tiles(const Grid &grid, std::size_t tile, unsigned level) {
  const LocalIndex *const start = tile_start_.data() + grid.start + tile;
  const std::size_t tiles = std::size_t{1} << (grid.bits - level);
  const Vertex first = start[0];
  const Vertex count = start[tiles] - first;
  if (count <= few)
    return conquer_few(first, count);
  if (level == grid.bits)
    return 8 * count > 7 * grid.sites ? conquer_by_median(first, count) : conquer_in_grid(first, count);
  const Vertex left_count = start[tiles / 2] - first;
  if (left_count == 0)
    return conquer_tiles(grid, tile + tiles / 2, level + 1);
  if (left_count == count)
    return conquer_tiles(grid, tile, level + 1);
  if (left_count == 1 || left_count == count - 1)
    return conquer_by_median(first, count);
  const Hull left = conquer_tiles(grid, tile, level + 1);
  const Hull right = conquer_tiles(grid, tile + tiles / 2, level + 1);
  return sphere_.merge(left, right, grid.axis(level), 6 * (first + left_count) - 6);
}

/// Sorts up to `lanes` sites by a coordinate rounded to 26 bits, without a branch on their values: each goes
/// to the place that as many others precede. False, with the sites as they were, if the rounding does not
/// separate the first `half` from the others. `low` and `high` bound the coordinate.
template <std::size_t lanes>
bool BucketKernel::sort_by_rank(Vertex first, Vertex count, Vertex half, unsigned axis, double low,
                                double high) {
  constexpr int number_bits = 4;
  static_assert(lanes <= 1U << number_bits);
  const auto n = static_cast<std::size_t>(count);
  const double scale = scale_of(low, high, 0x1p26);
  Point *const sites = point(first);
  LocalIndex *const numbers = number(first);
  std::array<NumberedSite, lanes> old;
  std::array<std::int32_t, lanes> key;
  key.fill(std::numeric_limits<std::int32_t>::max());
  for (std::size_t i = 0; i < n; ++i) {
    old[i] = {sites[i], numbers[i]};
    const double coordinate = axis == 0 ? sites[i].x : sites[i].y;
    key[i] =
        (static_cast<std::int32_t>((coordinate - low) * scale) << number_bits) + static_cast<std::int32_t>(i);
  }
  std::array<std::int32_t, lanes> rank{};
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t i = 0; i < lanes; ++i)
      rank[i] += key[j] < key[i] ? 1 : 0;
  std::array<std::int32_t, lanes> sorted{};
  for (std::size_t i = 0; i < n; ++i)
    sorted[static_cast<std::size_t>(rank[i])] = key[i];
  const auto cut = static_cast<std::size_t>(half);
  if (sorted[cut - 1] >> number_bits == sorted[cut] >> number_bits)
    return false;
  for (std::size_t i = 0; i < n; ++i) {
    sites[rank[i]] = old[i].point;
    numbers[rank[i]] = old[i].number;
  }
  return true;
}

Hull BucketKernel::conquer_few(Vertex first, Vertex count) {
  if (count == 2)
    return sphere_.two_sites(first);
  if (count == 3)
    return sphere_.three_sites(first);
  if (Hull hull; count == 4 && sphere_.four_sites(first, hull))
    return hull;
  const Box box = box_of(first, count);
  const unsigned axis = box.longer_side();
  const Vertex half = half_of(count);
  const double least = axis == 0 ? box.low[0] : box.low[1];
  const double greatest = axis == 0 ? box.high[0] : box.high[1];
  if (!fixed_point_is_safe() ||
      !(count <= few / 2 ? sort_by_rank<few / 2>(first, count, half, axis, least, greatest)
                         : sort_by_rank<few>(first, count, half, axis, least, greatest)))
    return conquer_by_median(first, count);
  const Hull left = conquer_few(first, half);
  const Hull right = conquer_few(first + half, count - half);
  return sphere_.merge(left, right, axis, 6 * (first + half) - 6);
}

/// The way that always works: an exact median, ties by the other coordinate. At least four sites.
Hull BucketKernel::conquer_by_median(Vertex first, Vertex count) {
  to_scratch(first, count);
  const std::span<NumberedSite> sites = std::span(scratch_).first(static_cast<std::size_t>(count));
  const unsigned axis = box_of(first, count).longer_side();
  const Vertex half = count <= few ? half_of(count) : count / 2;
  std::ranges::nth_element(sites, sites.begin() + half, [axis](const NumberedSite &a, const NumberedSite &b) {
    return less_along(a.point, b.point, axis);
  });
  take(scratch_.data(), first, count);
  const Hull left = conquer(first, half);
  const Hull right = conquer(first + half, count - half);
  return sphere_.merge(left, right, axis, 6 * (first + half) - 6);
}

} // namespace dovetail::divide_and_conquer
