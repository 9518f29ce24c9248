// What pictures are made of: pixels of triangles and lines, numbers of legends, letters.
#include "io/picture_font.hpp"
#include "io/picture_layout.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>

namespace dovetail {
namespace {

using picture::number_text;
using picture::Scale;
using picture::ticks_of;

constexpr Colour red{200, 0, 0};

/// How many samples each pixel has of a shape, by asking every sample.
template <class Inside> std::vector<int> counted_samples(const PixelBand &band, Inside &&inside) {
  std::vector<int> counts;
  for (int row = band.first_row; row < band.first_row + band.rows; ++row)
    for (int column = band.first_column; column < band.first_column + band.columns; ++column) {
      int count = 0;
      for (int sample = 0; sample < samples_a_pixel; ++sample) {
        const int line = sample / samples_a_side, place = sample % samples_a_side;
        if (inside(Point{column + (place + 0.5) / samples_a_side, row + (line + 0.5) / samples_a_side}))
          ++count;
      }
      counts.push_back(count);
    }
  return counts;
}

double side_of(Point a, Point b, Point p) { return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x); }

std::vector<Point> random_points(std::mt19937_64 &random, std::size_t count) {
  std::uniform_real_distribution<double> place(-6, 26);
  std::vector<Point> points(count);
  for (Point &p : points)
    p = {place(random), place(random)};
  return points;
}

TEST(Raster, TrianglesCoverTheSamplesInsideThem) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const std::vector<Point> p = random_points(random, 3);
    PixelBand band(3, 12, 2, 15);
    fill_triangle(band, {p[0], p[1], p[2]}, red);
    const auto expected = counted_samples(band, [&](Point s) {
      const double a = side_of(p[0], p[1], s);
      const double b = side_of(p[1], p[2], s);
      const double c = side_of(p[2], p[0], s);
      return (a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0);
    });
    for (std::size_t i = 0; i < expected.size(); ++i) {
      ASSERT_EQ(band.pixels[i].covered, static_cast<std::uint32_t>(expected[i]));
      ASSERT_EQ(band.pixels[i].red, band.pixels[i].covered * red.red);
    }
  }
}

TEST(Raster, LinesCoverTheSamplesNearThem) {
  std::mt19937_64 random(2);
  for (int trial = 0; trial < 200; ++trial) {
    const std::vector<Point> p = random_points(random, 2);
    const double half_width = trial % 8 * 0.4;
    PixelBand band(0, 20, 0, 20);
    draw_segment(band, p[0], p[1], half_width, LineLayer::hull);
    const Point along{p[1].x - p[0].x, p[1].y - p[0].y};
    const auto expected = counted_samples(band, [&](Point s) {
      const double t = std::clamp(((s.x - p[0].x) * along.x + (s.y - p[0].y) * along.y) /
                                      (along.x * along.x + along.y * along.y),
                                  0.0, 1.0);
      return std::hypot(s.x - p[0].x - t * along.x, s.y - p[0].y - t * along.y) <= half_width;
    });
    for (std::size_t i = 0; i < expected.size(); ++i)
      ASSERT_EQ(std::popcount(band.pixels[i].lines[static_cast<std::size_t>(LineLayer::hull)]), expected[i]);
  }
}

TEST(Raster, ASharedSideLeavesNoGapAndNoOverlap) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> inner(2, 14);
  for (int trial = 0; trial < 200; ++trial) {
    const Point middle{inner(random), inner(random)};
    const std::array<Point, 4> square{{{0, 0}, {16, 0}, {16, 16}, {0, 16}}};
    PixelBand band(0, 16, 0, 16);
    for (std::size_t i = 0; i < 4; ++i)
      fill_triangle(band, {middle, square[i], square[(i + 1) % 4]}, red);
    for (const PixelSum &pixel : band.pixels)
      ASSERT_EQ(pixel.covered, static_cast<std::uint32_t>(samples_a_pixel));
  }
}

TEST(Legend, NumbersHaveTheDecimalsThatTheyNeed) {
  EXPECT_EQ(number_text(0.5, 0.1), "0.5");
  EXPECT_EQ(number_text(100, 0.5), "100");
  EXPECT_EQ(number_text(-10, 0.02), "-10");
  EXPECT_EQ(number_text(6600100, 50), "6600100");
  EXPECT_EQ(number_text(1000000.75, 0.25), "1000000.8"); // one decimal tells it from its neighbours
  EXPECT_EQ(number_text(0.00123, 0.001), "0.001");
  EXPECT_EQ(number_text(1e300, 1e297), "1e+300");
  EXPECT_EQ(number_text(3e-200, 1e-203), "3e-200");
  EXPECT_EQ(number_text(7, 0), "7");
}

TEST(Legend, TicksAreRoundAndWithinTheScale) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> exponent(-12, 12);
  std::uniform_real_distribution<double> offset(-5, 5);
  for (int trial = 0; trial < 2000; ++trial) {
    const double span = std::pow(10, exponent(random));
    const bool logarithmic = trial % 2 == 0;
    const double low = logarithmic ? span : span * offset(random);
    const Scale scale{low, logarithmic ? low * std::pow(10, 0.01 + std::abs(offset(random)) * 2) : low + span,
                      logarithmic};
    const std::vector<double> ticks = ticks_of(scale);
    ASSERT_GE(ticks.size(), 2U);
    ASSERT_LE(ticks.size(), 12U);
    ASSERT_TRUE(std::is_sorted(ticks.begin(), ticks.end()));
    const double slack = logarithmic ? 1e-8 * low : 1e-8 * span;
    ASSERT_GE(ticks.front(), scale.low - slack);
    ASSERT_LE(ticks.back(), scale.high * (1 + 1e-8 * (scale.high > 0 ? 1 : -1)) + slack);
    const double ends = scale.position(ticks.back()) - scale.position(ticks.front());
    ASSERT_GT(ends, 0.3) << scale.low << " to " << scale.high; // of the bar
  }
}

TEST(Letters, EveryDotIsOnAStroke) {
  for (char letter = ' '; letter <= '~'; ++letter)
    for (int row = 0; row < picture::glyph_height; ++row)
      for (int column = 0; column < picture::glyph_width; ++column) {
        bool met = false;
        picture::for_each_stroke(letter, [&](picture::Dot from, picture::Dot to) {
          EXPECT_TRUE(picture::dot_of(letter, from.column, from.row));
          EXPECT_TRUE(picture::dot_of(letter, to.column, to.row));
          met = met || (from.column == column && from.row == row);
        });
        EXPECT_EQ(met, picture::dot_of(letter, column, row));
      }
}

} // namespace
} // namespace dovetail
