/// Which triangles are neighbours, as far as the caches are concerned. Private to mesh.
#pragma once

#include "dovetail/base/types.hpp"

#include <algorithm>
#include <cstdint>
#include <span>

namespace dovetail {

/// Parts of a domain with a few thousand vertices each, in an order in which what follows each other is near.
/// If most vertices are given, tiles are ranges of their numbers, and new triangles belong to the tile of
/// those they come from. If an area limit will make most of them, tiles are cells of a grid in Morton's
/// order.
class Tiles {
public:
  /// Vertices are given near ones near each other. max_area: 0 if there is none.
  Tiles(std::span<const Point> given, double max_area) {
    count_ = static_cast<std::int32_t>(given.size() >> size_bits) + 1;
    if (given.empty() || !(max_area > 0))
      return;
    Point low = given.front(), high = low;
    for (const Point &p : given) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    const double width = std::max(high.x - low.x, high.y - low.y);
    const double expected = width * width / max_area; // where the box is full
    if (!(expected > 4 * static_cast<double>(given.size())) || !(width > 0))
      return;
    while (grid_bits_ < most_grid_bits &&
           expected > static_cast<double>(std::int64_t{1} << (size_bits + 2 * grid_bits_)))
      ++grid_bits_;
    low_ = low;
    cells_per_length_ = static_cast<double>(1 << grid_bits_) / width;
    count_ = 1 << 2 * grid_bits_;
  }

  std::int32_t count() const { return count_; }
  std::int32_t of_given(LocalIndex vertex) const { return grid_bits_ > 0 ? 0 : vertex >> size_bits; }
  /// Of a triangle with this corner, made from one of the tile `parent`.
  std::int32_t of_new(Point corner, std::int32_t parent) const {
    return grid_bits_ > 0 ? spread(cell(corner.x - low_.x)) | spread(cell(corner.y - low_.y)) << 1 : parent;
  }

private:
  static constexpr int size_bits = 12;
  static constexpr int most_grid_bits = 8;

  std::int32_t cell(double offset) const {
    return std::clamp(static_cast<std::int32_t>(offset * cells_per_length_), 0, (1 << grid_bits_) - 1);
  }
  /// Bit i to place 2i.
  static std::int32_t spread(std::int32_t bits) {
    bits = (bits | bits << 4) & 0x0f0f;
    bits = (bits | bits << 2) & 0x3333;
    return (bits | bits << 1) & 0x5555;
  }

  std::int32_t count_ = 1;
  int grid_bits_ = 0; ///< 0: no grid
  Point low_{};
  double cells_per_length_ = 0;
};

} // namespace dovetail
