/// PNG, eight bits a channel, row after row, by libpng. Private to io. Local.
#pragma once

#include "dovetail/geometry/raster.hpp"

#include <cstddef>
#include <span>
#include <vector>

struct png_struct_def;
struct png_info_def;

namespace dovetail {

/// Compresses rows as they come; whoever calls writes `take()` to the file, in order.
class PngEncoder {
public:
  PngEncoder(int width, int height);
  PngEncoder(const PngEncoder &) = delete;
  PngEncoder &operator=(const PngEncoder &) = delete;
  ~PngEncoder();

  /// Whole rows.
  void add_rows(std::span<const Colour> pixels);
  /// After the last row.
  void finish();
  /// What has been encoded since the last call.
  std::vector<std::byte> take();

private:
  static void keep(png_struct_def *png, unsigned char *bytes, std::size_t count);
  static void keep_nothing(png_struct_def *png);

  std::size_t width_;
  png_struct_def *png_ = nullptr;
  png_info_def *about_ = nullptr;
  std::vector<std::byte> encoded_;
};

} // namespace dovetail
