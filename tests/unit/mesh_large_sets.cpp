/// Sets too large for brute force: the validator, the checksum under shuffles, the kernel by split paths, and
/// CGAL as an independent peer.
#include "dovetail/geometry/distributions.hpp"
#include "dovetail/mesh/checksum.hpp"
#include "dovetail/mesh/divide_and_conquer.hpp"
#include "dovetail/mesh/split_path_recursion.hpp"
#include "dovetail/mesh/validate.hpp"

#include "support/mesh_checks.hpp"

#ifdef DOVETAIL_TEST_CGAL
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

namespace dovetail {
namespace {

using testing::checksum_of;
using testing::distinct_sites;
using testing::first_fault;

class LargeSets : public ::testing::TestWithParam<Distribution> {};

TEST_P(LargeSets, ValidAndBlindToOrder) {
  std::vector<Point> sites = distinct_sites(GetParam(), 60'000);
  const Triangulation mesh = delaunay(sites);
  const FaultReport report = validate(sites, mesh);
  EXPECT_TRUE(report.valid()) << first_fault(report);
  const std::uint64_t checksum = checksum_of(sites, mesh);
  std::ranges::sort(sites, lexicographically_less);
  EXPECT_EQ(checksum_of(sites, delaunay(sites)), checksum);
  EXPECT_EQ(checksum_of(sites, delaunay_by_split_paths(sites)), checksum);
  std::ranges::reverse(sites);
  EXPECT_EQ(checksum_of(sites, delaunay(sites)), checksum);
}

#ifdef DOVETAIL_TEST_CGAL
class UnambiguousSets : public ::testing::TestWithParam<Distribution> {};

TEST_P(UnambiguousSets, SameTrianglesAsCgal) {
  using Peer = CGAL::Delaunay_triangulation_2<CGAL::Exact_predicates_inexact_constructions_kernel>;
  const std::vector<Point> sites =
      distinct_sites(GetParam(), GetParam() == Distribution::circle ? 5'000 : 100'000);
  const Triangulation mesh = delaunay(sites);
  Peer peer;
  std::vector<Peer::Point> points;
  for (const Point &site : sites)
    points.emplace_back(site.x, site.y);
  peer.insert(points.begin(), points.end());
  ASSERT_EQ(peer.number_of_faces(), static_cast<std::size_t>(mesh.triangle_count()));
  std::uint64_t checksum = checksum_of_sites(sites);
  for (auto face = peer.finite_faces_begin(); face != peer.finite_faces_end(); ++face) {
    std::array<Point, 3> corners;
    for (int i = 0; i < 3; ++i)
      corners[static_cast<std::size_t>(i)] = {face->vertex(i)->point().x(), face->vertex(i)->point().y()};
    checksum += checksum_of_triangles(corners, std::array<LocalIndex, 3>{0, 1, 2});
  }
  EXPECT_EQ(checksum_of(sites, mesh), checksum);
}
// Not lattice and lidar: their sites are cocircular, and CGAL breaks ties by another rule.
INSTANTIATE_TEST_SUITE_P(Mesh, UnambiguousSets,
                         ::testing::Values(Distribution::uniform, Distribution::normal, Distribution::kuzmin,
                                           Distribution::line, Distribution::circle, Distribution::clusters),
                         [](const auto &distribution) {
                           return std::string(distribution_name(distribution.param));
                         });
#endif

INSTANTIATE_TEST_SUITE_P(Mesh, LargeSets, ::testing::ValuesIn(all_distributions),
                         [](const auto &distribution) {
                           return std::string(distribution_name(distribution.param));
                         });

/// What a kernel must survive and small sets cannot show: many cuts through ties, and extreme shapes.
TEST(LargeAdversaries, Valid) {
  const auto check = [](const char *what, std::vector<Point> sites) {
    std::ranges::sort(sites, lexicographically_less);
    sites.erase(std::unique(sites.begin(), sites.end()), sites.end());
    std::mt19937_64 random(2);
    std::ranges::shuffle(sites, random);
    const FaultReport report = validate(sites, delaunay(sites));
    EXPECT_TRUE(report.valid()) << what << ": " << first_fault(report);
    const FaultReport by_paths = validate(sites, delaunay_by_split_paths(sites));
    EXPECT_TRUE(by_paths.valid()) << what << " by split paths: " << first_fault(by_paths);
  };
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Point> decimal, coarse, turned, mixed, vertical, cross, ulps, far, steep, scales;
  for (int i = 0; i < 8'000; ++i) {
    const double u = uniform(random);
    const double v = uniform(random);
    const int column = i % 90, row = i / 90;
    decimal.push_back({0.1 * column, 0.1 * row});
    // Short integers, so short that nothing is rounded, in small parts only.
    coarse.push_back({97.0 * column, 97.0 * row});
    turned.push_back({0.25 * (31 * column - 17 * row), 0.25 * (17 * column + 31 * row)});
    mixed.push_back({std::floor(column + (i % 7 == 0 ? 0x1p38 : 0.0)), 1.0 * row});
    vertical.push_back({0.25, u});
    cross.push_back(i % 2 == 0 ? Point{0, u - 0.5} : Point{v - 0.5, 0});
    ulps.push_back({1 + 0x1p-52 * std::floor(100 * u), 1 + 0x1p-52 * std::floor(100 * v)});
    far.push_back(i == 0 ? Point{1e300, -1e300} : Point{u, v});
    steep.push_back({u, 1e-9 * v});
    if (i % 4 == 0)
      scales.push_back({std::ldexp(u, -i % 900), std::ldexp(v, -i % 700)});
  }
  vertical.push_back({0.5, 0.5});
  check("decimal lattice", decimal);
  check("coarse lattice", coarse);
  check("turned lattice", turned);
  check("two lattices far apart", mixed);
  check("all but one on a vertical", vertical);
  check("cross", cross);
  check("one ulp apart", ulps);
  check("one far site", far);
  check("flat", steep);
  check("all scales", scales);
}

/// Levels halve the interior, every path site is counted, and paths are as long as they should be.
TEST(SplitPaths, TraceTellsTheLevels) {
  const std::vector<Point> sites = distinct_sites(Distribution::uniform, 20'000);
  SplitTrace trace;
  delaunay_by_split_paths(sites, &trace);
  ASSERT_GT(trace.levels.size(), 8U);
  EXPECT_EQ(trace.levels[0].subproblems, 1);
  EXPECT_EQ(trace.levels[0].interior + trace.levels[0].border, 20'000);
  const double root = std::sqrt(20'000.0);
  EXPECT_GT(static_cast<double>(trace.levels[0].path), root); // about 1.3 times the root
  EXPECT_LT(static_cast<double>(trace.levels[0].path), 1.7 * root);
  for (std::size_t depth = 0; depth + 1 < trace.levels.size(); ++depth) {
    const SplitLevel &level = trace.levels[depth], &below = trace.levels[depth + 1];
    EXPECT_LT(below.interior, level.interior);
    EXPECT_LE(below.largest, level.largest / 2);
    EXPECT_GE(level.bucketing(), 1.0);
    EXPECT_LE(level.longest_path, level.path);
  }
}

/// Coordinates up to the greatest double: differences overflow, and no fixed point may be made of them.
TEST(GreatestCoordinates, Valid) {
  constexpr double greatest = std::numeric_limits<double>::max();
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(-greatest / 2, greatest / 2);
    std::vector<Point> sites{{-greatest, greatest}, {greatest, -greatest}};
    for (unsigned i = 0; i < 1 + seed % 40; ++i)
      sites.push_back({2 * uniform(random), 2 * uniform(random)});
    const FaultReport report = validate(sites, delaunay(sites));
    ASSERT_TRUE(report.valid()) << "seed " << seed << ": " << first_fault(report);
  }
}

/// Coordinates of all magnitudes down to 2^-900, where products underflow and no filter can help.
TEST(ManyScales, Valid) {
  for (unsigned seed = 0; seed < 1500; ++seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<Point> sites;
    for (unsigned i = 0; i < 3 + seed % 20; ++i) {
      const double x = std::ldexp(uniform(random), -static_cast<int>(random() % 900));
      sites.push_back({x, std::ldexp(uniform(random), -static_cast<int>(random() % 700))});
    }
    const FaultReport report = validate(sites, delaunay(sites));
    ASSERT_TRUE(report.valid()) << "seed " << seed << ": " << first_fault(report);
  }
}

} // namespace
} // namespace dovetail
