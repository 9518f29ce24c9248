/// Both kernels against the definition, on small sets.
#include "dovetail/mesh/divide_and_conquer.hpp"
#include "dovetail/mesh/split_path_recursion.hpp"
#include "dovetail/mesh/validate.hpp"

#include "support/small_sites_families.hpp"
#include "support/small_sites_oracle.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace dovetail {
namespace {

using testing::IntegerSite;
using testing::Triple;

/// Integer sites moved by `shift` and then scaled by a power of two: exact as long as it fits 53 bits.
std::vector<Point> scaled(const std::vector<IntegerSite> &sites, std::int64_t shift, int exponent) {
  std::vector<Point> points;
  for (const IntegerSite &site : sites)
    points.push_back({std::ldexp(static_cast<double>(site.x + shift), exponent),
                      std::ldexp(static_cast<double>(site.y + shift), exponent)});
  return points;
}

std::set<Triple> triples(const Triangulation &mesh) {
  std::set<Triple> result;
  for (std::size_t i = 0; i + 2 < mesh.corners.size(); i += 3) {
    Triple triple{mesh.corners[i], mesh.corners[i + 1], mesh.corners[i + 2]};
    std::ranges::sort(triple);
    result.insert(triple);
  }
  return result;
}

/// Checks orientation and that neighbours[3t + i] is the triangle with the same edge reversed.
void expect_consistent(const std::vector<IntegerSite> &sites, const Triangulation &mesh) {
  ASSERT_EQ(mesh.corners.size(), mesh.neighbours.size());
  const auto corner = [&](std::size_t t, std::size_t i) { return mesh.corners[3 * t + i % 3]; };
  std::set<std::pair<LocalIndex, LocalIndex>> edges;
  const std::size_t triangles = mesh.corners.size() / 3;
  for (std::size_t t = 0; t < triangles; ++t) {
    for (std::size_t i = 0; i < 3; ++i)
      ASSERT_TRUE(edges.insert({corner(t, i + 1), corner(t, i + 2)}).second);
    const IntegerSite a = sites[static_cast<std::size_t>(corner(t, 0))];
    const IntegerSite b = sites[static_cast<std::size_t>(corner(t, 1))];
    const IntegerSite c = sites[static_cast<std::size_t>(corner(t, 2))];
    ASSERT_GT((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x), 0);
  }
  for (std::size_t t = 0; t < triangles; ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const LocalIndex other = mesh.neighbours[3 * t + i];
      const LocalIndex u = corner(t, i + 1);
      const LocalIndex v = corner(t, i + 2);
      if (other == none) {
        ASSERT_FALSE(edges.contains({v, u}));
        continue;
      }
      bool shared = false;
      for (std::size_t j = 0; j < 3; ++j)
        shared |= corner(static_cast<std::size_t>(other), j + 1) == v &&
                  corner(static_cast<std::size_t>(other), j + 2) == u;
      ASSERT_TRUE(shared);
    }
}

struct Kernel {
  const char *name;
  Triangulation (*triangulate)(std::span<const Point>);
};

constexpr Kernel kernels[] = {
    {"divide and conquer", [](std::span<const Point> sites) { return delaunay(sites); }},
    {"split paths", [](std::span<const Point> sites) { return delaunay_by_split_paths(sites); }}};

class SmallFamilies : public ::testing::TestWithParam<int> {};

TEST_P(SmallFamilies, EqualTheDefinition) {
  std::mt19937_64 random(static_cast<std::uint64_t>(GetParam()) + 1);
  for (int round = 0; round < 600; ++round) {
    const std::vector<IntegerSite> sites =
        testing::small_sites(GetParam(), round % 10 == 0 ? 40 : 16, random);
    const std::set<Triple> expected = testing::delaunay_by_definition(sites);
    const std::pair<std::int64_t, int> placements[] = {
        {0, 0}, {std::int64_t{1} << 51, -51}, {7, 498}, {-3, -498}, {0, -1000}, {0, 980}};
    for (const auto &[shift, exponent] : placements)
      for (const Kernel &kernel : kernels) {
        const Triangulation mesh = kernel.triangulate(scaled(sites, shift, exponent));
        ASSERT_EQ(triples(mesh), expected)
            << "round " << round << " scaled by 2^" << exponent << " by " << kernel.name;
        ASSERT_EQ(static_cast<std::size_t>(mesh.triangle_count()), expected.size());
        expect_consistent(sites, mesh);
        if (HasFatalFailure())
          return;
      }
  }
}

INSTANTIATE_TEST_SUITE_P(Mesh, SmallFamilies, ::testing::Range(0, testing::small_sites_family_count),
                         [](const auto &family) {
                           std::string name = testing::small_sites_family_name(family.param);
                           std::ranges::replace(name, ' ', '_');
                           return name;
                         });

RC_GTEST_PROP(Kernels, AnySmallSetEqualsTheDefinition,
              (std::vector<std::pair<std::int8_t, std::int8_t>> raw)) {
  std::set<IntegerSite> distinct;
  for (const auto &[x, y] : raw)
    distinct.insert({x % 8, y % 8});
  const std::vector<IntegerSite> sites(distinct.begin(), distinct.end());
  const std::set<Triple> expected = testing::delaunay_by_definition(sites);
  for (const Kernel &kernel : kernels)
    RC_ASSERT(triples(kernel.triangulate(scaled(sites, 0, 0))) == expected);
}

/// Where squares and slopes overflow and underflow beside each other.
TEST(Kernels, CoordinatesMayDifferByAnyNumberOfOrders) {
  std::mt19937_64 random(9);
  const auto draw = [&](int least, int most) { return std::uniform_int_distribution(least, most)(random); };
  const auto power = [&] { return std::ldexp(draw(0, 1) == 0 ? 1.0 : -1.0, draw(-1074, 1022)); };
  constexpr double tiny = 1e-306;
  std::vector<std::vector<Point>> sets{
      {{-tiny, 59}, {0, 1}, {0, 3}, {0, 15}, {0, 16}, {0, 18}, {0, 21}, {tiny, 48}}};
  for (int round = 0; round < 1000; ++round) {
    std::set<std::pair<double, double>> distinct;
    for (int count = draw(3, 40); count > 0; --count)
      distinct.insert({draw(0, 3) == 0 ? 0 : power(), draw(0, 3) == 0 ? draw(1, 60) : power()});
    std::vector<Point> &sites = sets.emplace_back();
    for (const auto &[x, y] : distinct)
      sites.push_back({x, y});
  }
  for (const std::vector<Point> &sites : sets)
    for (const Kernel &kernel : kernels) {
      const FaultReport report = validate(sites, kernel.triangulate(sites));
      ASSERT_TRUE(report.valid()) << "set " << &sites - sets.data() << " by " << kernel.name;
    }
}

TEST(Kernels, TooFewSitesHaveNoTriangles) {
  for (const Kernel &kernel : kernels) {
    EXPECT_EQ(kernel.triangulate({}).triangle_count(), 0);
    EXPECT_EQ(kernel.triangulate(std::vector<Point>{{1, 2}}).triangle_count(), 0);
    EXPECT_EQ(kernel.triangulate(std::vector<Point>{{1, 2}, {3, 4}}).triangle_count(), 0);
  }
}

TEST(Kernels, AreDeterministic) {
  std::mt19937_64 random(5);
  const std::vector<Point> points = scaled(testing::small_sites(2, 40, random), 0, 0);
  for (const Kernel &kernel : kernels) {
    const Triangulation once = kernel.triangulate(points);
    const Triangulation again = kernel.triangulate(points);
    EXPECT_EQ(once.corners, again.corners);
    EXPECT_EQ(once.neighbours, again.neighbours);
  }
}

} // namespace
} // namespace dovetail
