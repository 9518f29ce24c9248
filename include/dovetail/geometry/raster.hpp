/// Triangles and lines as pixels. Everything a band of pixels holds can be added to another band (sums of
/// colours, sets of samples), so the picture does not depend on who drew what, nor in which order. Local.
///
/// A pixel has samples_a_side^2 samples in a lattice. Coordinates are in pixels, y downwards, and pixel
/// (column, row) covers column .. column + 1 and row .. row + 1.
#pragma once

#include "dovetail/base/types.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace dovetail {

struct Colour {
  std::uint8_t red, green, blue;
  friend constexpr bool operator==(const Colour &, const Colour &) = default;
};

inline constexpr int samples_a_side = 4;
inline constexpr int samples_a_pixel = samples_a_side * samples_a_side;

/// Lines are drawn above the triangles, in this order.
enum class LineLayer : std::uint8_t { edges, casing, hull, paths };
inline constexpr std::size_t line_layers = 4;

/// What is known of a pixel so far.
struct PixelSum {
  std::uint32_t red = 0, green = 0, blue = 0;     ///< sums over the samples that triangles cover
  std::uint32_t covered = 0;                      ///< how many
  std::array<std::uint16_t, line_layers> lines{}; ///< a bit for each sample that a line of the layer covers

  void add(const PixelSum &other);
  bool is_empty() const;
};

/// Rows first_row .. first_row + rows - 1 of some columns of a picture, row by row.
struct PixelBand {
  int first_row = 0, rows = 0;
  int first_column = 0, columns = 0;
  std::vector<PixelSum> pixels;

  PixelBand(int begin_row, int row_count, int begin_column, int column_count);
  PixelSum *row(int number) {
    return pixels.data() + static_cast<std::size_t>(number - first_row) * static_cast<std::size_t>(columns);
  }
};

/// Every sample between the sides takes the colour. Triangles that share a side leave no gap and no overlap
/// along it, up to samples within rounding of the side. Points that are not finite draw nothing.
void fill_triangle(PixelBand &band, const std::array<Point, 3> &corners, Colour colour);

/// All samples within half_width of the segment, its round ends included.
void draw_segment(PixelBand &band, Point from, Point to, double half_width, LineLayer layer);

/// How the lines of a layer look: `weight` of 255 is opaque.
struct Ink {
  Colour colour;
  int weight;
};
Colour resolve(const PixelSum &pixel, Colour background, const std::array<Ink, line_layers> &inks);

} // namespace dovetail
