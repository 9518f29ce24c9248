/// Polygons cut out of Delaunay triangulations along their edges, triangulated again.
#include "mesh/polygon_triangulation.hpp"

#include "dovetail/geometry/distributions.hpp"
#include "dovetail/mesh/divide_and_conquer.hpp"

#include "support/small_sites_families.hpp"

#include <algorithm>
#include <array>
#include <gtest/gtest.h>
#include <numeric>
#include <random>
#include <set>
#include <vector>

namespace dovetail {
namespace {

using Corners = std::array<LocalIndex, 3>;

Corners from_least(LocalIndex a, LocalIndex b, LocalIndex c) {
  Corners corners{a, b, c};
  std::ranges::rotate(corners, std::ranges::min_element(corners));
  return corners;
}

/// A simple polygon, counter-clockwise, and the triangles inside.
struct Patch {
  std::vector<LocalIndex> polygon;
  std::set<Corners> triangles;
};

/// Grows from a random triangle: across an edge of the polygon, if the corner there is a new one. So the
/// polygon stays simple, bends in and out as it likes, and has no vertex inside.
Patch random_patch(const Triangulation &mesh, std::mt19937_64 &random) {
  const auto below = [&](std::size_t bound) { return random() % bound; };
  const auto corner = [&](std::size_t t, std::size_t i) { return mesh.corners[3 * t + i % 3]; };
  struct Edge {
    std::size_t triangle, opposite; ///< corner across from the edge
  };
  Patch patch;
  const std::size_t first = below(mesh.corners.size() / 3);
  std::vector<Edge> border{{first, 2}, {first, 0}, {first, 1}}; // each begins at the corner after `opposite`
  std::set<LocalIndex> vertices{corner(first, 0), corner(first, 1), corner(first, 2)};
  patch.triangles.insert(from_least(corner(first, 0), corner(first, 1), corner(first, 2)));
  for (std::size_t tries = 4 * mesh.corners.size(); tries > 0; --tries) {
    const std::size_t place = below(border.size());
    const auto [t, i] = border[place];
    const LocalIndex across = mesh.neighbours[3 * t + i];
    if (across == none)
      continue;
    const auto u = static_cast<std::size_t>(across);
    std::size_t j = 0; // the corner of u across from the shared edge
    while (mesh.neighbours[3 * u + j] != static_cast<LocalIndex>(t) || corner(u, j + 2) != corner(t, i + 1))
      ++j;
    if (!vertices.insert(corner(u, j)).second)
      continue;
    patch.triangles.insert(from_least(corner(u, 0), corner(u, 1), corner(u, 2)));
    // The edge from a to b becomes a to the new corner, and on to b.
    border[place] = {u, (j + 1) % 3};
    border.insert(border.begin() + static_cast<std::ptrdiff_t>(place) + 1, {u, (j + 2) % 3});
  }
  for (const auto &[t, i] : border)
    patch.polygon.push_back(corner(t, i + 1));
  return patch;
}

void expect_same_triangles(std::span<const Point> sites, int patches, std::mt19937_64 &random) {
  const Triangulation mesh = delaunay(sites);
  if (mesh.corners.empty())
    return;
  PolygonTriangulation triangulation(sites);
  for (int i = 0; i < patches; ++i) {
    const Patch patch = random_patch(mesh, random);
    std::vector<LocalIndex> corners;
    triangulation.solve(patch.polygon, corners);
    std::set<Corners> found;
    for (std::size_t t = 0; t < corners.size(); t += 3)
      found.insert(from_least(corners[t], corners[t + 1], corners[t + 2]));
    ASSERT_EQ(corners.size(), 3 * found.size());
    ASSERT_EQ(found, patch.triangles) << "polygon of " << patch.polygon.size();
  }
}

class PolygonsOfFamilies : public ::testing::TestWithParam<int> {};

TEST_P(PolygonsOfFamilies, HaveTheirTriangles) {
  std::mt19937_64 random(static_cast<std::uint64_t>(GetParam()) + 1);
  for (int round = 0; round < 300; ++round) {
    std::vector<Point> sites;
    for (const auto &[x, y] : testing::small_sites(GetParam(), 40, random))
      sites.push_back({static_cast<double>(x), static_cast<double>(y)});
    expect_same_triangles(sites, 5, random);
  }
}
INSTANTIATE_TEST_SUITE_P(Mesh, PolygonsOfFamilies, ::testing::Range(0, testing::small_sites_family_count),
                         [](const auto &family) {
                           std::string name = testing::small_sites_family_name(family.param);
                           std::ranges::replace(name, ' ', '_');
                           return name;
                         });

class PolygonsOfDistributions : public ::testing::TestWithParam<Distribution> {};

TEST_P(PolygonsOfDistributions, HaveTheirTriangles) {
  std::mt19937_64 random(1);
  for (const GlobalIndex n : {30, 300, 3000}) {
    std::vector<Point> sites(static_cast<std::size_t>(n));
    generate_points({GetParam(), n, 1}, 0, sites);
    std::ranges::sort(sites, lexicographically_less);
    sites.erase(std::unique(sites.begin(), sites.end()), sites.end());
    std::ranges::shuffle(sites, random);
    expect_same_triangles(sites, n < 3000 ? 20 : 3, random);
  }
}
INSTANTIATE_TEST_SUITE_P(Mesh, PolygonsOfDistributions, ::testing::ValuesIn(all_distributions),
                         [](const auto &distribution) {
                           return std::string(distribution_name(distribution.param));
                         });

} // namespace
} // namespace dovetail
