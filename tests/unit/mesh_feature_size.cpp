#include "dovetail/mesh/feature_size.hpp"

#include "dovetail/mesh/constrain.hpp"
#include "dovetail/mesh/refine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace dovetail {
namespace {

double distance_from(Point p, Point a, Point b) {
  const double dx = b.x - a.x, dy = b.y - a.y, length = dx * dx + dy * dy;
  const double t = length > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / length, 0.0, 1.0) : 0;
  return std::hypot(a.x + t * dx - p.x, a.y + t * dy - p.y);
}

/// By the definition: of all pairs that do not touch, the one of which the farther is nearest.
double by_all_pairs(const PlanarGraph &graph, Point p) {
  std::vector<Segment> features = graph.segments;
  for (LocalIndex v = 0; v < static_cast<LocalIndex>(graph.vertices.size()); ++v)
    features.push_back({v, v});
  const auto far = [&](const Segment &f) {
    return distance_from(p, graph.vertices[static_cast<std::size_t>(f.from)],
                         graph.vertices[static_cast<std::size_t>(f.to)]);
  };
  double least = INFINITY;
  for (const Segment &f : features)
    for (const Segment &g : features)
      if (f.from != g.from && f.from != g.to && f.to != g.from && f.to != g.to)
        least = std::min(least, std::max(far(f), far(g)));
  return least;
}

/// A square with a slit, a smaller square, a star of hanging lines and vertices of their own.
PlanarGraph domain() {
  PlanarGraph graph;
  graph.vertices = {{0, 0}, {4, 0},   {4, 4},   {0, 4},     {1, 1},    {1.5, 1},  {1.5, 1.5}, {1, 1.5},
                    {3, 3}, {3.5, 3}, {3, 3.6}, {2.5, 2.9}, {0.25, 3}, {0.35, 3}, {3.8, 0.2}};
  graph.segments = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {8, 9}, {8, 10}, {8, 11}};
  graph.holes = {{1.2, 1.2}};
  return graph;
}
const std::vector<LocalIndex> alone{12, 13, 14};

TEST(FeatureSize, IsThatOfAllPairs) {
  const PlanarGraph graph = domain();
  const FeatureSize size(graph.vertices, graph.segments, alone);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(0, 4);
  for (int i = 0; i < 500; ++i) {
    const Point p{uniform(random), uniform(random)};
    EXPECT_NEAR(size.at(p), by_all_pairs(graph, p), 1e-12);
  }
  EXPECT_EQ(FeatureSize({}, {}, {}).at({0, 0}), INFINITY);
}

TEST(FeatureSize, IntegralIsWithinOnePercent) {
  const PlanarGraph graph = domain();
  const FeatureSize size(graph.vertices, graph.segments, alone);
  // The middles of a fine grid's squares, of those not in the hole.
  constexpr int n = 700;
  double expected = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const Point p{4 * (i + 0.5) / n, 4 * (j + 0.5) / n};
      if (!(p.x > 1 && p.x < 1.5 && p.y > 1 && p.y < 1.5))
        expected += 16.0 / n / n / (size.at(p) * size.at(p));
    }
  Constrained coarse = constrain(graph);
  EXPECT_NEAR(integrate_feature_density(coarse.mesh, size).value_or(0), expected, 0.01 * expected);
  const Refined fine = refine(std::move(coarse.mesh), graph.segments, {.min_angle = 25});
  EXPECT_NEAR(integrate_feature_density(fine.mesh, size).value_or(0), expected, 0.01 * expected);
}

/// Needles that doubles resolve less and less.
TEST(FeatureSize, IntegralEnds) {
  for (const double width : {1e-9, 1e-12, 1e-300}) {
    PlanarGraph graph;
    graph.vertices = {{0, 0}, {1e6, 0}, {1e6, width}};
    graph.segments = {{0, 1}, {1, 2}, {2, 0}};
    const FeatureSize size(graph.vertices, graph.segments, {});
    const auto integral = integrate_feature_density(constrain(graph).mesh, size);
    EXPECT_TRUE(!integral || (std::isfinite(*integral) && *integral > 0));
  }
}

} // namespace
} // namespace dovetail
