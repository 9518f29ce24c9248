/// Every distribution, built in every way the kernel knows: one checksum. 100,000 points with DOVETAIL_FULL.
#include "dovetail/mesh/divide_and_conquer.hpp"
#include "dovetail/mesh/flip.hpp"
#include "dovetail/mesh/insert.hpp"
#include "dovetail/mesh/nearest.hpp"
#include "dovetail/mesh/remove.hpp"
#include "dovetail/mesh/space_filling_order.hpp"
#include "dovetail/mesh/split_path_recursion.hpp"

#include "support/mesh_checks.hpp"

#include <algorithm>
#include <cstdlib>
#include <gtest/gtest.h>
#include <random>

namespace dovetail {
namespace {

using testing::checksum_of;
using testing::distinct_sites;
using testing::first_fault;

GlobalIndex points_to_insert() { return std::getenv("DOVETAIL_FULL") != nullptr ? 100'000 : 5'000; }

class Distributions : public ::testing::TestWithParam<Distribution> {
protected:
  /// In random order.
  std::vector<Point> points = distinct_sites(GetParam(), points_to_insert());
  const Triangulation divided = delaunay(points);
  const std::uint64_t checksum = checksum_of(points, divided);

  void expect_the_same(const std::vector<Point> &sites, const Triangulation &mesh) const {
    const FaultReport report = validate(sites, mesh);
    EXPECT_TRUE(report.valid()) << first_fault(report);
    EXPECT_EQ(checksum_of(sites, mesh), checksum);
  }
};

INSTANTIATE_TEST_SUITE_P(Mesh, Distributions, ::testing::ValuesIn(all_distributions),
                         [](const auto &distribution) {
                           return std::string(distribution_name(distribution.param));
                         });

TEST_P(Distributions, ByDivideAndConquerAndBySplitPaths) {
  expect_the_same(points, divided);
  expect_the_same(points, delaunay_by_split_paths(points));
}

TEST_P(Distributions, ByFlipsInThreeOrders) {
  std::vector<Point> sorted = points;
  std::ranges::sort(sorted, lexicographically_less);
  std::vector<Point> along_curve;
  for (const LocalIndex i : space_filling_order(points))
    along_curve.push_back(points[position(i)]);
  for (const auto *order : {&points, &sorted, &along_curve}) {
    std::vector<Point> sites;
    Triangulation mesh;
    Cavity memory;
    LocalIndex hint = none;
    for (const Point &point : *order)
      hint = insert_by_flips(sites, mesh, point, order == &points ? none : hint, memory).triangle;
    expect_the_same(sites, mesh);
  }
}

TEST_P(Distributions, ByCavities) {
  std::vector<Point> sites;
  Triangulation mesh;
  const std::vector<LocalIndex> vertices = insert_batch(sites, mesh, points);
  expect_the_same(sites, mesh);
  for (std::size_t i = 0; i < points.size(); ++i)
    ASSERT_EQ(sites[position(vertices[i])], points[i]);
  sites.clear();
  mesh = {};
  insert_in_order(sites, mesh, points);
  expect_the_same(sites, mesh);
}

/// Other points come and go again: half of them as a batch, half one by one.
TEST_P(Distributions, ByRemovalAfterInsertion) {
  std::vector<Point> sites = points;
  Triangulation mesh = divided;
  std::vector<Point> more(points.size() / 2);
  generate_points({GetParam(), static_cast<GlobalIndex>(more.size()), 77}, 0, more);
  insert_batch(sites, mesh, more);
  EXPECT_TRUE(validate(sites, mesh).valid());
  std::vector<LocalIndex> added;
  for (std::size_t v = points.size(); v < sites.size(); ++v)
    added.push_back(static_cast<LocalIndex>(v));
  std::mt19937_64 random(7);
  std::ranges::shuffle(added, random);
  remove_batch(sites, mesh, std::span(added).first(added.size() / 2));
  EXPECT_TRUE(validate(sites, mesh).valid());
  RemovalMemory memory;
  LocalIndex near = none;
  while (sites.size() > points.size())
    near = remove(sites, mesh, static_cast<LocalIndex>(sites.size() - 1), near, memory).triangle;
  expect_the_same(sites, mesh);
}

TEST_P(Distributions, EverySiteIsItsOwnNearest) {
  LocalIndex hint = 0;
  for (LocalIndex v = 0; position(v) < points.size(); v += 7) {
    ASSERT_EQ(nearest_site(points, divided, points[position(v)], hint), v);
    hint = locate(points, divided, points[position(v)], hint).triangle;
  }
}

} // namespace
} // namespace dovetail
