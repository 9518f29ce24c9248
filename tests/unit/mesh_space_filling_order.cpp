/// The order of insertion: that it is one of all points, and that points follow each other closely, however
/// unevenly they lie.
#include "dovetail/mesh/space_filling_order.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

namespace dovetail {
namespace {

constexpr int scales = 12;
constexpr std::size_t points_of_a_scale = 2000;

/// Squares of which each is a millionth of the one before, all at one corner.
std::vector<Point> nested_squares(std::mt19937_64 &random) {
  std::vector<Point> points;
  std::uniform_real_distribution<double> unit(0.5, 1);
  for (int scale = 0; scale < scales; ++scale)
    for (std::size_t i = 0; i < points_of_a_scale; ++i)
      points.push_back({unit(random) * std::pow(1e-6, scale), unit(random) * std::pow(1e-6, scale)});
  std::ranges::shuffle(points, random);
  return points;
}

bool is_permutation_of_numbers(std::vector<LocalIndex> order) {
  std::ranges::sort(order);
  for (std::size_t i = 0; i < order.size(); ++i)
    if (order[i] != static_cast<LocalIndex>(i))
      return false;
  return true;
}

TEST(SpaceFillingOrder, NamesEveryPointOnce) {
  constexpr double huge = std::numeric_limits<double>::max(),
                   tiny = std::numeric_limits<double>::denorm_min();
  std::mt19937_64 random(1);
  for (const std::size_t n : {0U, 1U, 2U, 15U, 16U, 17U, 100U, 3000U})
    for (const double scale : {0.0, tiny, 1.0, huge}) {
      std::uniform_int_distribution<int> digit(-3, 3);
      std::vector<Point> points(n);
      for (Point &p : points)
        p = {digit(random) / 3.0 * scale, digit(random) / 3.0 * scale};
      const std::vector<LocalIndex> order = space_filling_order(points);
      EXPECT_EQ(order.size(), n);
      EXPECT_TRUE(is_permutation_of_numbers(order)) << n << " points of size " << scale;
    }
}

TEST(SpaceFillingOrder, FollowsPointsWhereverTheyCrowd) {
  std::mt19937_64 random(2);
  const std::vector<Point> points = nested_squares(random);
  const std::vector<LocalIndex> order = space_filling_order(points);
  ASSERT_TRUE(is_permutation_of_numbers(order));
  // Along a curve through a square, n points follow each other at about its side over sqrt n.
  const double near = 5 / std::sqrt(points_of_a_scale);
  std::size_t close = 0;
  for (std::size_t i = 1; i < order.size(); ++i) {
    const Point a = points[static_cast<std::size_t>(order[i - 1])],
                b = points[static_cast<std::size_t>(order[i])];
    close += std::hypot(a.x - b.x, a.y - b.y) < near * std::max(a.x, b.x);
  }
  EXPECT_GT(close, order.size() * 95 / 100);
}

} // namespace
} // namespace dovetail
