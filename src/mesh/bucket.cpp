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

BucketKernel::Box BucketKernel::box_of(Vertex first, Vertex count) {
  Box box{*point(first), *point(first)};
  for (Vertex v = first + 1; v < first + count; ++v)
    box.add(*point(v));
  return box;
}

Hull BucketKernel::triangulate(Vertex first, Vertex count, Vertex far_ghost) {
  first_ = first;
  count_ = count;
  gather();
  sphere_ = {{points_.data(), first}, corner_, twin_, first + count, guard_};
  sort_into_tiles();
  const Hull hull = conquer_tiles(0, 0);
  HalfEdge ghost = hull.first[0];
  do {
    corner_[ghost] = narrow(far_ghost);
    ghost = sphere_.ghost_after(ghost);
  } while (ghost != hull.first[0]);
  return hull;
}

void BucketKernel::gather() {
  const auto n = static_cast<std::size_t>(count_);
  if (points_.size() < n + 1) {
    points_.resize(n + 1);
    scratch_.resize(n);
    key_.resize(n);
  }
  box_.low = box_.high = sites_[static_cast<std::size_t>(*index(first_))];
  for (std::size_t i = 0; i < n; ++i) {
    const LocalIndex site = index(first_)[i];
    const Point p = sites_[static_cast<std::size_t>(site)];
    scratch_[i] = {p, site};
    box_.add(p);
  }
  points_[n] = far_away;
}

/// A counting sort by the tiles of a grid, numbered so that halving a range of tiles is a cut across the
/// longer side. Tiles are monotone in each coordinate, so they separate sites strictly.
void BucketKernel::sort_into_tiles() {
  const auto n = static_cast<std::size_t>(count_);
  bits_ = n < 2 * per_tile || !fixed_point_is_safe()
              ? 0
              : static_cast<unsigned>(std::bit_width(n / per_tile)) - 1;
  if (bits_ == 0) { // one tile; where differences may overflow, nothing here may be computed
    for (std::size_t i = 0; i < n; ++i) {
      points_[i] = scratch_[i].point;
      index(first_)[i] = scratch_[i].index;
    }
    tile_start_ = {narrow(first_), narrow(first_ + count_)};
    return;
  }
  double width = box_.high.x - box_.low.x;
  double height = box_.high.y - box_.low.y;
  axis_of_level_.clear();
  std::array<unsigned, 2> levels{};
  for (unsigned level = 0; level < bits_; ++level) {
    const unsigned axis = height > width ? 1 : 0;
    (axis == 0 ? width : height) /= 2;
    axis_of_level_.push_back(axis);
    ++levels[axis];
  }
  // spread[axis][tile along the axis] has the tile's bits where the levels of this axis want them.
  std::array<std::vector<std::uint32_t>, 2> spread;
  for (unsigned axis = 0; axis < 2; ++axis) {
    spread[axis].assign(std::size_t{1} << levels[axis], 0);
    unsigned bit = levels[axis];
    for (unsigned level = 0; level < bits_; ++level)
      if (axis_of_level_[level] == axis) {
        --bit;
        for (std::size_t tile = 0; tile < spread[axis].size(); ++tile)
          spread[axis][tile] |= static_cast<std::uint32_t>(tile >> bit & 1) << (bits_ - 1 - level);
      }
  }
  const double x_scale = scale_of(box_.low.x, box_.high.x, static_cast<double>(spread[0].size()));
  const double y_scale = scale_of(box_.low.y, box_.high.y, static_cast<double>(spread[1].size()));
  const std::size_t tiles = std::size_t{1} << bits_;
  tile_start_.assign(tiles + 1, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const Point p = scratch_[i].point;
    const auto x = static_cast<std::uint32_t>(static_cast<std::int32_t>((p.x - box_.low.x) * x_scale));
    const auto y = static_cast<std::uint32_t>(static_cast<std::int32_t>((p.y - box_.low.y) * y_scale));
    key_[i] = spread[0][x] | spread[1][y];
    ++tile_start_[key_[i]];
  }
  LocalIndex next = narrow(first_);
  for (std::size_t tile = 0; tile <= tiles; ++tile) {
    const LocalIndex here = tile_start_[tile];
    tile_start_[tile] = next;
    next += here;
  }
  for (std::size_t i = 0; i < n; ++i) {
    const LocalIndex to = tile_start_[key_[i]]++;
    *point(to) = scratch_[i].point;
    *index(to) = scratch_[i].index;
  }
  for (std::size_t tile = tiles; tile > 0; --tile)
    tile_start_[tile] = tile_start_[tile - 1];
  tile_start_[0] = narrow(first_);
}

/// The 2^(bits - level) tiles that begin with `tile`. At least two sites.
Hull BucketKernel::conquer_tiles(std::size_t tile, unsigned level) {
  const std::size_t tiles = std::size_t{1} << (bits_ - level);
  const Vertex first = tile_start_[tile];
  const Vertex count = tile_start_[tile + tiles] - first;
  if (count <= few)
    return conquer_few(first, count);
  if (level == bits_)
    return conquer_by_median(first, count);
  const Vertex left_count = tile_start_[tile + tiles / 2] - first;
  if (left_count == 0)
    return conquer_tiles(tile + tiles / 2, level + 1);
  if (left_count == count)
    return conquer_tiles(tile, level + 1);
  if (left_count == 1 || left_count == count - 1)
    return conquer_by_median(first, count);
  const Hull left = conquer_tiles(tile, level + 1);
  const Hull right = conquer_tiles(tile + tiles / 2, level + 1);
  return sphere_.merge(left, right, axis_of_level_[level], 6 * (first + left_count) - 6);
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
  LocalIndex *const numbers = index(first);
  std::array<Point, lanes> old_sites;
  std::array<LocalIndex, lanes> old_numbers;
  std::array<std::int32_t, lanes> key;
  key.fill(std::numeric_limits<std::int32_t>::max());
  for (std::size_t i = 0; i < n; ++i) {
    old_sites[i] = sites[i];
    old_numbers[i] = numbers[i];
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
    sites[rank[i]] = old_sites[i];
    numbers[rank[i]] = old_numbers[i];
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
  const double least = axis == 0 ? box.low.x : box.low.y;
  const double greatest = axis == 0 ? box.high.x : box.high.y;
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
  const std::span<Numbered> sites = std::span(scratch_).first(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < sites.size(); ++i)
    sites[i] = {point(first)[i], index(first)[i]};
  const Box box = box_of(first, count);
  const unsigned axis = box.longer_side();
  const Vertex half = count <= few ? half_of(count) : count / 2;
  std::ranges::nth_element(sites, sites.begin() + half, [axis](const Numbered &a, const Numbered &b) {
    return less_along(a.point, b.point, axis);
  });
  for (std::size_t i = 0; i < sites.size(); ++i) {
    point(first)[i] = sites[i].point;
    index(first)[i] = sites[i].index;
  }
  const auto conquer = [this](Vertex from, Vertex size) {
    return size <= few ? conquer_few(from, size) : conquer_by_median(from, size);
  };
  const Hull left = conquer(first, half);
  const Hull right = conquer(first + half, count - half);
  return sphere_.merge(left, right, axis, 6 * (first + half) - 6);
}

} // namespace dovetail::divide_and_conquer
