/// Insertion and removal against the definition, on small sets.
#include "dovetail/mesh/divide_and_conquer.hpp"
#include "dovetail/mesh/flip.hpp"
#include "dovetail/mesh/insert.hpp"
#include "dovetail/mesh/remove.hpp"
#include "dovetail/mesh/validate.hpp"

#include "support/small_sites_families.hpp"
#include "support/small_sites_oracle.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace dovetail {
namespace {

using testing::IntegerSite;
using testing::Triple;

std::vector<Point> points_of(const std::vector<IntegerSite> &sites) {
  std::vector<Point> points;
  for (const IntegerSite &site : sites)
    points.push_back({static_cast<double>(site.x), static_cast<double>(site.y)});
  return points;
}

std::string first_fault(const FaultReport &report) {
  return report.valid()
             ? ""
             : std::string(name_of(report.first_faults[0].kind)) + ": " + report.first_faults[0].text;
}

class SmallFamilies : public ::testing::TestWithParam<int> {};

TEST_P(SmallFamilies, ValidInAnyOrder) {
  std::mt19937_64 random(static_cast<std::uint64_t>(GetParam()) + 1);
  for (int round = 0; round < 600; ++round) {
    const std::vector<Point> points =
        points_of(testing::small_sites(GetParam(), round % 10 == 0 ? 40 : 16, random));
    std::vector<Point> sites;
    Triangulation mesh;
    const std::vector<LocalIndex> vertices =
        round % 2 == 0 ? insert_batch(sites, mesh, points) : insert_in_order(sites, mesh, points);
    const FaultReport report = validate(sites, mesh);
    ASSERT_TRUE(report.valid()) << "round " << round << ' ' << first_fault(report);
    ASSERT_EQ(sites.size(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      ASSERT_EQ(sites[static_cast<std::size_t>(vertices[i])], points[i]);
    sites.clear();
    mesh = {};
    Cavity memory;
    for (const Point &point : points)
      insert_by_flips(sites, mesh, point, none, memory);
    const FaultReport flipped = validate(sites, mesh);
    ASSERT_TRUE(flipped.valid()) << "round " << round << ' ' << first_fault(flipped);
    RemovalMemory removal;
    while (!sites.empty()) {
      remove(sites, mesh, static_cast<LocalIndex>(random() % sites.size()), none, removal);
      const FaultReport removed = validate(sites, mesh);
      ASSERT_TRUE(removed.valid()) << "round " << round << ' ' << first_fault(removed);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Mesh, SmallFamilies, ::testing::Range(0, testing::small_sites_family_count),
                         [](const auto &family) {
                           std::string name = testing::small_sites_family_name(family.param);
                           std::ranges::replace(name, ' ', '_');
                           return name;
                         });

} // namespace
} // namespace dovetail
