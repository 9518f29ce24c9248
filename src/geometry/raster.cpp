#include "dovetail/geometry/raster.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace dovetail {
namespace {

constexpr double per_pixel = samples_a_side;

/// The first sample, or row of samples, whose middle is not below `position`, within begin .. end.
int first_sample(double position, int begin, int end) {
  return static_cast<int>(
      std::clamp(std::ceil(position - 0.5), static_cast<double>(begin), static_cast<double>(end)));
}

/// `count` samples of the pixel take the colour.
void add_colour(PixelSum &pixel, Colour colour, int count) {
  const auto times = static_cast<std::uint32_t>(count);
  pixel.red += times * colour.red;
  pixel.green += times * colour.green;
  pixel.blue += times * colour.blue;
  pixel.covered += times;
}

/// Where a side crosses the height y. The same for both triangles of the side: it always runs downwards.
double crossing(Point upper, Point lower, double y) {
  return upper.x + (y - upper.y) * ((lower.x - upper.x) / (lower.y - upper.y));
}

bool is_finite(Point p) { return std::isfinite(p.x) && std::isfinite(p.y); }

int blend(int below, int above, int share, int whole) {
  return (below * (whole - share) + above * share + whole / 2) / whole;
}

} // namespace

void PixelSum::add(const PixelSum &other) {
  red += other.red;
  green += other.green;
  blue += other.blue;
  covered += other.covered;
  for (std::size_t layer = 0; layer < line_layers; ++layer)
    lines[layer] = static_cast<std::uint16_t>(lines[layer] | other.lines[layer]);
}

bool PixelSum::is_empty() const {
  return covered == 0 && std::all_of(lines.begin(), lines.end(), [](std::uint16_t set) { return set == 0; });
}

PixelBand::PixelBand(int begin_row, int row_count, int begin_column, int column_count)
    : first_row(begin_row), rows(row_count), first_column(begin_column), columns(column_count),
      pixels(static_cast<std::size_t>(row_count) * static_cast<std::size_t>(column_count)) {}

void fill_triangle(PixelBand &band, const std::array<Point, 3> &corners, Colour colour) {
  std::array<Point, 3> p{};
  for (std::size_t i = 0; i < 3; ++i) {
    if (!is_finite(corners[i]))
      return;
    p[i] = {corners[i].x * per_pixel, corners[i].y * per_pixel};
  }
  std::sort(p.begin(), p.end(), [](Point a, Point b) { return a.y < b.y || (a.y == b.y && a.x < b.x); });
  const int begin_row = band.first_row * samples_a_side;
  const int end_row = begin_row + band.rows * samples_a_side;
  const int begin_column = band.first_column * samples_a_side;
  const int end_column = begin_column + band.columns * samples_a_side;
  const int last = first_sample(p[2].y, begin_row, end_row);
  for (int y = first_sample(p[0].y, begin_row, end_row); y < last; ++y) {
    const double height = y + 0.5;
    // The long side is crossed at every height, and one of the other two.
    double left = crossing(p[0], p[2], height);
    double right = height < p[1].y ? crossing(p[0], p[1], height) : crossing(p[1], p[2], height);
    if (right < left)
      std::swap(left, right);
    const int end = first_sample(right, begin_column, end_column);
    PixelSum *const row = band.row(y / samples_a_side) - band.first_column;
    for (int x = first_sample(left, begin_column, end_column); x < end;) {
      const int next = std::min(end, (x / samples_a_side + 1) * samples_a_side);
      add_colour(row[x / samples_a_side], colour, next - x);
      x = next;
    }
  }
}

void draw_segment(PixelBand &band, Point from, Point to, double half_width, LineLayer layer) {
  if (!is_finite(from) || !is_finite(to))
    return;
  Point a{from.x * per_pixel, from.y * per_pixel};
  Point b{to.x * per_pixel, to.y * per_pixel};
  if (b.y < a.y || (b.y == a.y && b.x < a.x))
    std::swap(a, b);
  const double reach = half_width * per_pixel;
  const Point along{b.x - a.x, b.y - a.y};
  const double squared = along.x * along.x + along.y * along.y;
  const auto x_at = [&](double y) { // of the segment, its ends included
    return along.y > 0 ? a.x + std::clamp((y - a.y) / along.y, 0.0, 1.0) * along.x : a.x;
  };
  const int begin_row = band.first_row * samples_a_side;
  const int begin_column = band.first_column * samples_a_side;
  const int end_column = begin_column + band.columns * samples_a_side;
  const int last = first_sample(b.y + reach + 1, begin_row, begin_row + band.rows * samples_a_side);
  for (int y = first_sample(a.y - reach, begin_row, last); y < last; ++y) {
    const double height = y + 0.5;
    double left = x_at(height - reach);
    double right = along.y > 0 ? x_at(height + reach) : b.x;
    if (right < left)
      std::swap(left, right);
    const int end = first_sample(right + reach + 1, begin_column, end_column);
    PixelSum *const row = band.row(y / samples_a_side) - band.first_column;
    for (int x = first_sample(left - reach, begin_column, end_column); x < end; ++x) {
      const Point d{x + 0.5 - a.x, height - a.y};
      const double t = squared > 0 ? std::clamp((d.x * along.x + d.y * along.y) / squared, 0.0, 1.0) : 0.0;
      const Point off{d.x - t * along.x, d.y - t * along.y};
      if (off.x * off.x + off.y * off.y > reach * reach)
        continue;
      std::uint16_t &set = row[x / samples_a_side].lines[static_cast<std::size_t>(layer)];
      const int bit = (y % samples_a_side) * samples_a_side + x % samples_a_side;
      set = static_cast<std::uint16_t>(set | (1U << static_cast<unsigned>(bit)));
    }
  }
}

Colour resolve(const PixelSum &pixel, Colour background, const std::array<Ink, line_layers> &inks) {
  const auto whole = std::max<std::uint32_t>(pixel.covered, samples_a_pixel);
  const std::uint32_t bare = whole - pixel.covered;
  std::array<int, 3> colour{static_cast<int>((pixel.red + bare * background.red + whole / 2) / whole),
                            static_cast<int>((pixel.green + bare * background.green + whole / 2) / whole),
                            static_cast<int>((pixel.blue + bare * background.blue + whole / 2) / whole)};
  for (std::size_t layer = 0; layer < line_layers; ++layer) {
    const int share = std::popcount(pixel.lines[layer]) * inks[layer].weight;
    const Colour ink = inks[layer].colour;
    const std::array<int, 3> above{ink.red, ink.green, ink.blue};
    for (std::size_t i = 0; i < 3; ++i)
      colour[i] = blend(colour[i], above[i], share, samples_a_pixel * 255);
  }
  return {static_cast<std::uint8_t>(colour[0]), static_cast<std::uint8_t>(colour[1]),
          static_cast<std::uint8_t>(colour[2])};
}

} // namespace dovetail
