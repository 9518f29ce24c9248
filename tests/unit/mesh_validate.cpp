#include "dovetail/mesh/validate.hpp"

#include "dovetail/mesh/divide_and_conquer.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <set>

namespace dovetail {
namespace {

std::vector<Point> random_sites(int count) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform;
  std::vector<Point> sites;
  for (int i = 0; i < count; ++i)
    sites.push_back({uniform(random), uniform(random)});
  return sites;
}

std::set<FaultKind> kinds(const FaultReport &report) {
  std::set<FaultKind> result;
  for (std::size_t i = 0; i < fault_kinds; ++i)
    if (report.faults_by_kind[i] > 0)
      result.insert(static_cast<FaultKind>(i));
  return result;
}

/// Neighbours found from the corners alone, so that only what a test breaks is broken.
Triangulation with_neighbours(std::vector<LocalIndex> corners) {
  Triangulation mesh;
  mesh.corners = std::move(corners);
  mesh.neighbours.assign(mesh.corners.size(), none);
  const auto corner = [&](std::size_t h, std::size_t shift) {
    return mesh.corners[h / 3 * 3 + (h + shift) % 3];
  };
  for (std::size_t a = 0; a < mesh.corners.size(); ++a)
    for (std::size_t b = 0; b < mesh.corners.size(); ++b)
      if (corner(a, 1) == corner(b, 2) && corner(a, 2) == corner(b, 1))
        mesh.neighbours[a] = static_cast<LocalIndex>(b / 3);
  return mesh;
}

class BrokenMesh : public ::testing::Test {
protected:
  std::vector<Point> sites = random_sites(60);
  Triangulation mesh = delaunay(sites);

  std::size_t inner_triangle() const {
    for (std::size_t t = 0; t < mesh.corners.size(); t += 3)
      if (std::ranges::none_of(std::span(mesh.neighbours).subspan(t, 3),
                               [](LocalIndex n) { return n == none; }))
        return t;
    return 0;
  }
  std::size_t boundary_side() const {
    return static_cast<std::size_t>(std::ranges::find(mesh.neighbours, none) - mesh.neighbours.begin());
  }
  std::vector<LocalIndex> corners_without(std::size_t triangle) const {
    std::vector<LocalIndex> corners = mesh.corners;
    corners.erase(corners.begin() + static_cast<std::ptrdiff_t>(triangle),
                  corners.begin() + static_cast<std::ptrdiff_t>(triangle) + 3);
    return corners;
  }
  std::set<FaultKind> found() const { return kinds(validate(sites, mesh)); }
};

TEST_F(BrokenMesh, NotAtAll) {
  const FaultReport report = validate(sites, mesh);
  EXPECT_TRUE(report.valid());
  EXPECT_EQ(3 * mesh.triangle_count(), 2 * report.inner_edges + report.hull_edges);
}

TEST_F(BrokenMesh, CornerOutOfRange) {
  mesh.corners[4] = 60;
  EXPECT_EQ(found(), std::set{FaultKind::layout});
}

TEST_F(BrokenMesh, NeighbourOutOfRange) {
  mesh.neighbours[4] = mesh.triangle_count();
  EXPECT_EQ(found(), std::set{FaultKind::layout});
}

TEST_F(BrokenMesh, NeighboursCutShort) {
  mesh.neighbours.pop_back();
  EXPECT_EQ(found(), std::set{FaultKind::layout});
}

TEST_F(BrokenMesh, SwappedCorners) {
  std::swap(mesh.corners[3], mesh.corners[4]);
  std::swap(mesh.neighbours[3], mesh.neighbours[4]);
  EXPECT_TRUE(found().contains(FaultKind::orientation));
  EXPECT_TRUE(found().contains(FaultKind::adjacency));
}

TEST_F(BrokenMesh, SameCornerTwice) {
  mesh.corners[4] = mesh.corners[3];
  EXPECT_TRUE(found().contains(FaultKind::orientation));
}

TEST_F(BrokenMesh, WrongNeighbour) {
  const std::size_t t = inner_triangle();
  std::swap(mesh.neighbours[t], mesh.neighbours[t + 1]);
  EXPECT_EQ(found(), std::set{FaultKind::adjacency});
}

TEST_F(BrokenMesh, OneSidedNeighbour) {
  mesh.neighbours[inner_triangle()] = none;
  EXPECT_TRUE(found().contains(FaultKind::adjacency));
  EXPECT_TRUE(found().contains(FaultKind::hull));
}

TEST_F(BrokenMesh, ItsOwnNeighbour) {
  const std::size_t side = boundary_side();
  mesh.neighbours[side] = static_cast<LocalIndex>(side / 3);
  EXPECT_TRUE(found().contains(FaultKind::adjacency));
}

TEST_F(BrokenMesh, FlippedEdge) {
  // Flip the first inner edge whose two triangles form a convex quadrilateral.
  for (std::size_t h = 0; h < mesh.corners.size(); ++h) {
    const LocalIndex other = mesh.neighbours[h];
    if (other == none)
      continue;
    const std::size_t t = h / 3 * 3;
    const std::size_t o = 3 * static_cast<std::size_t>(other);
    const LocalIndex a = mesh.corners[h];
    const LocalIndex b = mesh.corners[t + (h + 1) % 3];
    const LocalIndex c = mesh.corners[t + (h + 2) % 3];
    LocalIndex d = none;
    for (std::size_t i = 0; i < 3; ++i)
      if (mesh.corners[o + i] != b && mesh.corners[o + i] != c)
        d = mesh.corners[o + i];
    std::vector<LocalIndex> corners = mesh.corners;
    const LocalIndex first[3] = {a, b, d};
    const LocalIndex second[3] = {a, d, c};
    std::copy(first, first + 3, corners.begin() + static_cast<std::ptrdiff_t>(t));
    std::copy(second, second + 3, corners.begin() + static_cast<std::ptrdiff_t>(o));
    const Triangulation flipped = with_neighbours(std::move(corners));
    const auto t_index = static_cast<LocalIndex>(t / 3);
    if (!is_counter_clockwise(sites, flipped, t_index) || !is_counter_clockwise(sites, flipped, other))
      continue;
    const FaultReport report = validate(sites, flipped);
    EXPECT_EQ(kinds(report), std::set{FaultKind::delaunay});
    return;
  }
  FAIL() << "no edge to flip";
}

TEST_F(BrokenMesh, MissingInnerTriangle) {
  mesh = with_neighbours(corners_without(inner_triangle()));
  EXPECT_TRUE(found().contains(FaultKind::hull));
}

TEST_F(BrokenMesh, DentedHull) {
  // Without a triangle that has exactly one side on the hull, the boundary is still one cycle.
  for (std::size_t t = 0; t < mesh.corners.size(); t += 3)
    if (std::ranges::count(std::span(mesh.neighbours).subspan(t, 3), none) == 1) {
      mesh = with_neighbours(corners_without(t));
      break;
    }
  EXPECT_EQ(found(), std::set{FaultKind::hull});
}

TEST_F(BrokenMesh, DuplicatedTriangle) {
  const std::size_t t = inner_triangle();
  for (std::size_t i = 0; i < 3; ++i) {
    mesh.corners.push_back(mesh.corners[t + i]);
    mesh.neighbours.push_back(mesh.neighbours[t + i]);
  }
  EXPECT_EQ(found(), (std::set{FaultKind::adjacency, FaultKind::euler}));
}

TEST_F(BrokenMesh, DuplicatedTriangleAlone) {
  const std::size_t t = inner_triangle();
  for (std::size_t i = 0; i < 3; ++i) {
    mesh.corners.push_back(mesh.corners[t + i]);
    mesh.neighbours.push_back(none);
  }
  EXPECT_TRUE(found().contains(FaultKind::hull));
  EXPECT_TRUE(found().contains(FaultKind::euler));
}

TEST_F(BrokenMesh, UnusedSite) {
  sites.push_back({0.5, 0.5});
  EXPECT_EQ(found(), (std::set{FaultKind::unused_site, FaultKind::euler}));
}

TEST_F(BrokenMesh, MovedSite) {
  const std::size_t t = inner_triangle();
  sites[static_cast<std::size_t>(mesh.corners[t])] = {17, 4};
  EXPECT_TRUE(found().contains(FaultKind::orientation));
}

TEST_F(BrokenMesh, NoTrianglesThoughThereShouldBe) {
  mesh = {};
  EXPECT_EQ(found(), std::set{FaultKind::collinear});
}

TEST_F(BrokenMesh, KeepsTheFirstAndCountsAll) {
  for (std::size_t t = 0; t < 30; t += 3)
    std::swap(mesh.corners[t], mesh.corners[t + 1]);
  const FaultReport report = validate(sites, mesh, 4);
  EXPECT_EQ(report.first_faults.size(), 4U);
  EXPECT_EQ(report.count(FaultKind::orientation), 10);
  EXPECT_GT(report.fault_count, 10);
}

// Five triangles around a centre, joined so that the boundary is a pentagram that winds twice: every triangle
// is counter-clockwise, every inner edge locally Delaunay, every turn left, and Euler's relation holds.
TEST(Validate, BoundaryThatWindsTwice) {
  std::vector<Point> sites{{0, 0}};
  for (int i = 0; i < 5; ++i)
    sites.push_back({std::cos(i * 2 * std::acos(-1.0) / 5), std::sin(i * 2 * std::acos(-1.0) / 5)});
  std::vector<LocalIndex> corners;
  for (LocalIndex i = 0; i < 5; ++i)
    corners.insert(corners.end(), {0, 1 + 2 * i % 5, 1 + (2 * i + 2) % 5});
  const FaultReport report = validate(sites, with_neighbours(corners));
  EXPECT_EQ(kinds(report), std::set{FaultKind::hull});
  ASSERT_FALSE(report.first_faults.empty());
  EXPECT_NE(report.first_faults[0].text.find("winds 2 times"), std::string::npos);
}

TEST(Validate, TheOtherDiagonalOfASquareIsNotCanonical) {
  const std::vector<Point> square{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  EXPECT_TRUE(validate(square, with_neighbours({0, 1, 3, 1, 2, 3})).valid());
  EXPECT_EQ(kinds(validate(square, with_neighbours({0, 1, 2, 0, 2, 3}))), std::set{FaultKind::delaunay});
}

TEST(Validate, TwoSeparateTriangulations) {
  const std::vector<Point> sites{{0, 0}, {1, 0}, {0, 1}, {5, 0}, {6, 0}, {5, 1}};
  EXPECT_TRUE(kinds(validate(sites, with_neighbours({0, 1, 2, 3, 4, 5}))).contains(FaultKind::hull));
}

TEST(Validate, NothingIsValid) {
  EXPECT_TRUE(validate({}, {}).valid());
  EXPECT_TRUE(validate(std::vector<Point>{{1, 1}, {2, 2}, {3, 3}, {5, 5}}, {}).valid());
}

TEST(Validate, NamesEveryKind) {
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < fault_kinds; ++i)
    names.insert(name_of(static_cast<FaultKind>(i)));
  EXPECT_EQ(names.size(), fault_kinds);
}

} // namespace
} // namespace dovetail
