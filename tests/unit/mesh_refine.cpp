/// Refinement: what is promised holds, on everything, and it ends.
#include "dovetail/mesh/refine.hpp"

#include "dovetail/base/error.hpp"
#include "dovetail/geometry/distributions.hpp"
#include "dovetail/mesh/checksum.hpp"
#include "dovetail/mesh/constrain.hpp"
#include "dovetail/mesh/quality.hpp"
#include "dovetail/mesh/validate_domain.hpp"
#include "support/domain_families.hpp"
#include "support/failing_allocation.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

namespace dovetail {
namespace {

constexpr std::size_t index(LocalIndex i) { return static_cast<std::size_t>(i); }

struct Domain {
  DomainMesh mesh;
  std::vector<Segment> segments;
};

Domain constrained(const PlanarGraph &graph, Outline outline = Outline::segments) {
  Constrained result = constrain(graph, {.outline = outline});
  std::vector<Segment> segments = graph.segments;
  segments.insert(segments.end(), result.hull_segments.begin(), result.hull_segments.end());
  return {std::move(result.mesh), std::move(segments)};
}

Refined refined(const Domain &domain, double min_angle) {
  return refine(domain.mesh, domain.segments, {.min_angle = min_angle});
}

PlanarGraph uniform_points(GlobalIndex count) {
  PlanarGraph graph;
  graph.vertices.resize(static_cast<std::size_t>(count));
  generate_points({Distribution::uniform, count, 1}, 0, graph.vertices);
  return graph;
}

PlanarGraph square(double low, double high) {
  PlanarGraph graph;
  graph.vertices = {{low, low}, {high, low}, {high, high}, {low, high}};
  graph.segments = {{0, 1, 11}, {1, 2, 12}, {2, 3, 13}, {3, 0, 14}};
  return graph;
}

std::array<Point, 3> corners_of(const DomainMesh &mesh, std::size_t t) {
  std::array<Point, 3> corner;
  for (std::size_t i = 0; i < 3; ++i)
    corner[i] = mesh.vertices[index(mesh.triangles.corners[3 * t + i])];
  return corner;
}

/// By the law of cosines, in extended precision: nothing that the code uses.
double least_angle(const std::array<Point, 3> &corner) {
  std::array<long double, 3> side{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Point a = corner[(i + 1) % 3], b = corner[(i + 2) % 3];
    side[i] = std::hypot(static_cast<long double>(a.x) - b.x, static_cast<long double>(a.y) - b.y);
  }
  std::ranges::sort(side);
  const long double cosine =
      (side[1] * side[1] + side[2] * side[2] - side[0] * side[0]) / (2 * side[1] * side[2]);
  return static_cast<double>(std::acos(std::min(cosine, 1.0L)) * 57.295779513082320877L);
}

std::size_t triangles_below(const DomainMesh &mesh, double degrees) {
  std::size_t count = 0;
  for (std::size_t t = 0; t < mesh.region.size(); ++t)
    count += least_angle(corners_of(mesh, t)) < degrees ? 1U : 0U;
  return count;
}

double greatest_area(const DomainMesh &mesh, std::int32_t region = none) {
  double greatest = 0;
  for (std::size_t t = 0; t < mesh.region.size(); ++t) {
    const auto [a, b, c] = corners_of(mesh, t);
    if (region == none || mesh.region[t] == region)
      greatest = std::max(greatest, ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2);
  }
  return greatest;
}

/// Subsegments that the apex of a triangle beside them sees under more than a right angle.
std::size_t encroached_subsegments(const DomainMesh &mesh) {
  std::size_t count = 0;
  for (std::size_t side = 0; side < mesh.segment_of_side.size(); ++side)
    if (mesh.segment_of_side[side] != none) {
      const auto corner = corners_of(mesh, side / 3);
      const Point a = corner[(side + 1) % 3], b = corner[(side + 2) % 3], c = corner[side % 3];
      count += (a.x - c.x) * (b.x - c.x) + (a.y - c.y) * (b.y - c.y) < 0 ? 1U : 0U;
    }
  return count;
}

void expect_valid(const DomainMesh &mesh, std::span<const Segment> segments, double min_angle = 0) {
  const DomainReport report = validate_domain(mesh, segments, min_angle);
  EXPECT_TRUE(report.valid()) << (report.valid() ? "" : report.first_faults.front().text);
}

std::uint64_t checksum(const DomainMesh &mesh) {
  return checksum_of_triangles(mesh.vertices, mesh.triangles.corners);
}

TEST(Refine, FamiliesAtThreeAngles) {
  for (const auto &[name, graph] : testing::domain_families()) {
    SCOPED_TRACE(name);
    const Domain domain = constrained(graph);
    for (const double degrees : {20.0, 26.45, 30.0}) {
      const Refined result = refined(domain, degrees);
      expect_valid(result.mesh, domain.segments, degrees);
      EXPECT_TRUE(result.left_subsegments.empty());
      for (const LeftTriangle &left : result.left_triangles)
        EXPECT_EQ(left.reason, LeftReason::small_input_angle);
      // Rounding at the bound itself may be either way.
      EXPECT_LE(triangles_below(result.mesh, degrees - 1e-9), result.left_triangles.size());
      EXPECT_GE(triangles_below(result.mesh, degrees + 1e-9), result.left_triangles.size());
      EXPECT_EQ(encroached_subsegments(result.mesh), 0U);
      EXPECT_TRUE(std::equal(graph.vertices.begin(), graph.vertices.end(), result.mesh.vertices.begin()));
    }
  }
}

TEST(Refine, PointsInTheirHullTakeNoMoreThanTheBestDo) {
  const Domain domain = constrained(uniform_points(20'000), Outline::convex_hull);
  // Triangle 1.6 has 1.553, 2.755 and 3.69 for a million (300,000) points; the border costs the rest.
  for (const auto &[degrees, ratio] : {std::pair{20.0, 1.60}, {30.0, 2.85}, {33.0, 3.84}}) {
    const Refined result = refined(domain, degrees);
    expect_valid(result.mesh, domain.segments, degrees);
    EXPECT_EQ(triangles_below(result.mesh, degrees - 1e-9), 0U);
    EXPECT_LT(static_cast<double>(result.mesh.vertices.size()), ratio * 20'000);
    EXPECT_EQ(result.mesh.vertices.size(),
              20'000U + index(result.points_inside) + index(result.points_on_segments));
  }
}

TEST(Refine, AreasAndMarkers) {
  const Domain domain = constrained(square(0, 1));
  const Refined result = refine(domain.mesh, domain.segments, {.min_angle = 30, .max_area = 1e-4});
  expect_valid(result.mesh, domain.segments, 30);
  EXPECT_LE(greatest_area(result.mesh), 1e-4);
  // Triangle needs 1.58 triangles of the greatest area's size at 1.55e-6.
  EXPECT_LT(result.mesh.region.size(), 17'000U);
  for (std::size_t v = 4; v < result.mesh.vertices.size(); ++v) {
    const Point p = result.mesh.vertices[v];
    const std::int32_t expected = p.y == 0 ? 11 : p.x == 1 ? 12 : p.y == 1 ? 13 : p.x == 0 ? 14 : 0;
    EXPECT_EQ(result.mesh.vertex_markers[v], expected);
  }
}

TEST(Refine, EveryRegionHasItsArea) {
  PlanarGraph graph = square(0, 1);
  graph.vertices.insert(graph.vertices.end(), {{0.4, 0.4}, {0.6, 0.4}, {0.6, 0.6}, {0.4, 0.6}});
  graph.segments.insert(graph.segments.end(), {{4, 5, 2}, {5, 6, 2}, {6, 7, 2}, {7, 4, 2}});
  graph.regions = {{{0.1, 0.1}, 1, 0}, {{0.5, 0.5}, 2, 0}};
  const Domain domain = constrained(graph);
  const Refined result = refine(domain.mesh, domain.segments,
                                {.min_angle = 25, .max_area = 0.01, .max_area_of_region = {0, 1e-4}});
  expect_valid(result.mesh, domain.segments, 25);
  EXPECT_LE(greatest_area(result.mesh, 0), 0.01);
  EXPECT_LE(greatest_area(result.mesh, 1), 1e-4);
  EXPECT_GT(greatest_area(result.mesh, 0), 1e-3);
}

struct BoundaryPiece {
  Point from, to;
  double length;
};

/// Pieces of segments, and the pair of vertices that the test adds.
std::vector<BoundaryPiece> boundary_pieces(const DomainMesh &mesh, std::span<const LocalIndex> alone) {
  std::vector<BoundaryPiece> pieces;
  for (const LocalIndex v : alone)
    pieces.push_back({mesh.vertices[index(v)], mesh.vertices[index(v)], HUGE_VAL});
  for (std::size_t side = 0; side < mesh.segment_of_side.size(); ++side) {
    const auto corner = corners_of(mesh, side / 3);
    const Point a = corner[(side + 1) % 3], b = corner[(side + 2) % 3];
    const double length = std::hypot(a.x - b.x, a.y - b.y);
    if (mesh.segment_of_side[side] != none)
      pieces.push_back({a, b, length});
    for (std::size_t i = 0; i < alone.size(); ++i)
      if (pieces[i].from == a || pieces[i].from == b)
        pieces[i].length = std::min(pieces[i].length, length);
  }
  return pieces;
}

/// Of edges at p, from every piece.
double permitted(Point p, std::span<const BoundaryPiece> pieces, double growth) {
  double least = HUGE_VAL;
  for (const auto &[a, b, length] : pieces) {
    const double dx = b.x - a.x, dy = b.y - a.y, squared = dx * dx + dy * dy;
    const double t =
        squared > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / squared, 0.0, 1.0) : 0.0;
    least = std::min(least, length + growth * std::hypot(a.x + t * dx - p.x, a.y + t * dy - p.y));
  }
  return least;
}

/// The field is what the mesh without one says of the boundary, whatever is between here and there. A slit, a
/// pair of vertices, and a hole with small features beyond a wall.
TEST(Refine, SizesGrowWithTheDistanceFromTheBoundary) {
  PlanarGraph graph = square(-1, 1);
  graph.vertices.insert(graph.vertices.end(),
                        {{0, 0}, {0.01, 0}, {-0.5, 0.5}, {0.5, 0.5}, {-0.5, 0.51}, {0.5, 0.51}});
  graph.segments.insert(graph.segments.end(), {{6, 7, 1}, {8, 9, 2}});
  const std::vector<LocalIndex> alone{4, 5};
  const Domain domain = constrained(graph);
  const Refined plain = refined(domain, 20);
  const std::vector<BoundaryPiece> pieces = boundary_pieces(plain.mesh, alone);
  std::size_t before = plain.mesh.region.size();
  for (const double growth : {1.0, 0.3, 0.1}) {
    const Refined result =
        refine(domain.mesh, domain.segments, {.min_angle = 20, .growth = growth, .lone_vertices = alone});
    expect_valid(result.mesh, domain.segments, 20);
    EXPECT_TRUE(result.left_triangles.empty());
    EXPECT_EQ(index(result.points_inside + result.points_on_segments),
              result.mesh.vertices.size() - domain.mesh.vertices.size());
    double ideal = 0; // triangles that are as large as they may be
    for (std::size_t t = 0; t < result.mesh.region.size(); ++t) {
      const auto [a, b, c] = corners_of(result.mesh, t);
      const double area = ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2;
      const double edge = permitted({(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3}, pieces, growth);
      const double limit = std::sqrt(3) / 4 * edge * edge;
      EXPECT_LE(area, limit * (1 + 1e-9));
      ideal += area / limit;
    }
    EXPECT_GT(result.mesh.region.size(), before);
    before = result.mesh.region.size();
    EXPECT_LT(static_cast<double>(before - plain.mesh.region.size()), 3 * ideal);
  }
}

TEST(Refine, AgainAndFurther) {
  const Domain domain = constrained(testing::random_segments(100, 9));
  const Refined once = refined(domain, 22);
  const Refined again = refine(once.mesh, domain.segments, {.min_angle = 22});
  EXPECT_EQ(checksum(again.mesh), checksum(once.mesh));
  EXPECT_EQ(again.points_inside + again.points_on_segments, 0);
  const Refined further = refine(once.mesh, domain.segments, {.min_angle = 28, .max_area = 1e-3});
  expect_valid(further.mesh, domain.segments, 28);
  EXPECT_LE(greatest_area(further.mesh), 1e-3);
  EXPECT_EQ(checksum(refined(domain, 22).mesh), checksum(once.mesh));
}

/// Room is reserved before it is needed, and memory may be limited.
TEST(Refine, NoRoomIsReservedThatOtherLimitsKeepFromBeingUsed) {
  const Domain domain = constrained(square(0, 1));
  const testing::FailingAllocation scarce(std::size_t{4} << 20, 0);
  (void)refine(domain.mesh, domain.segments, {.max_area = 1e-8, .min_edge = 0.02});
  (void)refine(domain.mesh, domain.segments, {.max_area = 1e-8, .max_points = 5'000});
  EXPECT_FALSE(testing::FailingAllocation::has_struck());
}

TEST(Refine, LimitsAreKeptAndReported) {
  const Domain domain = constrained(testing::slits(4, 1e-3));
  const Refined few = refine(domain.mesh, domain.segments, {.min_angle = 25, .max_points = 500});
  EXPECT_EQ(few.mesh.vertices.size(), 500U);
  expect_valid(few.mesh, domain.segments);
  EXPECT_EQ(few.left_triangles.size(), triangles_below(few.mesh, 25));
  EXPECT_TRUE(std::ranges::all_of(few.left_triangles,
                                  [](const LeftTriangle &t) { return t.reason == LeftReason::max_points; }));

  const Refined coarse = refine(domain.mesh, domain.segments, {.min_angle = 25, .min_edge = 0.01});
  expect_valid(coarse.mesh, domain.segments);
  EXPECT_EQ(coarse.left_triangles.size(), triangles_below(coarse.mesh, 25));
  EXPECT_GT(coarse.left_triangles.size(), 0U);
  EXPECT_GT(coarse.left_subsegments.size(), 0U);
  for (const LeftTriangle &t : coarse.left_triangles)
    EXPECT_EQ(t.reason, LeftReason::min_edge);
  for (std::size_t side = 0; side < coarse.mesh.triangles.corners.size(); ++side) {
    const std::size_t base = side - side % 3;
    const LocalIndex a = coarse.mesh.triangles.corners[base + (side + 1) % 3],
                     b = coarse.mesh.triangles.corners[base + (side + 2) % 3];
    if (index(std::max(a, b)) >= domain.mesh.vertices.size()) {
      EXPECT_GE(distance(coarse.mesh.vertices[index(a)], coarse.mesh.vertices[index(b)]), 0.01);
    }
  }
}

/// The sides that cross x = 0.5 are locked. Their triangles stay; what is left waits for them, or for long
/// subsegments of the hull that wait for them.
TEST(Refine, LockedEdgesStayWithTheirTriangles) {
  const Domain domain = constrained(uniform_points(2'000), Outline::convex_hull);
  const auto crosses = [](Point a, Point b) { return (a.x < 0.5) != (b.x < 0.5); };
  const auto locked = [&](LocalIndex t, int side) {
    const auto corner = corners_of(domain.mesh, index(t));
    const auto i = static_cast<std::size_t>(side);
    return crosses(corner[(i + 1) % 3], corner[(i + 2) % 3]);
  };
  const Refined result = refine(domain.mesh, domain.segments, {.min_angle = 25, .locked = locked});
  expect_valid(result.mesh, domain.segments);
  const auto crossing = [&](const DomainMesh &mesh) {
    std::uint64_t sum = 0;
    for (std::size_t t = 0; t < mesh.region.size(); ++t)
      if (const auto [a, b, c] = corners_of(mesh, t); crosses(a, b) || crosses(b, c))
        sum += checksum_of_triangles(mesh.vertices, std::span(mesh.triangles.corners).subspan(3 * t, 3));
    return sum;
  };
  EXPECT_EQ(crossing(result.mesh), crossing(domain.mesh));
  EXPECT_GT(result.left_triangles.size(), 5U);
  EXPECT_LT(result.left_triangles.size(), result.mesh.region.size() / 20);
  for (const LeftTriangle &left : result.left_triangles)
    EXPECT_EQ(left.reason, LeftReason::locked);
}

/// Vertices next to each other in the last place: whatever is asked for, there is no room.
TEST(Refine, EndsWhereDoublesDo) {
  PlanarGraph graph = square(1, 2);
  const double ulp = std::numeric_limits<double>::epsilon();
  graph.vertices.insert(graph.vertices.end(),
                        {{1.5, 1.5}, {1.5 + ulp, 1.5}, {1.5, 1.5 + ulp}, {1.5 + 9 * ulp, 1.5}});
  graph.segments.push_back({4, 7, 1});
  graph.vertices.insert(graph.vertices.begin() + 8, {1.25, 1.75});
  graph.segments.pop_back();
  const Domain domain = constrained(graph);
  const Refined result = refined(domain, 30);
  expect_valid(result.mesh, domain.segments);
  EXPECT_GT(result.left_triangles.size(), 0U);
  for (const LeftTriangle &left : result.left_triangles)
    EXPECT_EQ(left.reason, LeftReason::precision);

  PlanarGraph wedge; // thinner than doubles resolve, far away
  wedge.vertices = {{1e7, 1e7}, {1e7 + 1, 1e7}, {1e7 + 1, 1e7 + 2e-9}, {1e7 - 1, 1e7 + 1}};
  wedge.segments = {{0, 1, 1}, {1, 2, 1}, {2, 3, 1}, {3, 0, 1}};
  const Domain thin = constrained(wedge);
  const Refined result_thin = refined(thin, 30);
  expect_valid(result_thin.mesh, thin.segments);
}

/// Short segments a little apart, in a large square far away: their middles are rounded, and at first
/// triangles beside them are needles, whose circles leave no room for that. Once these are gone there is.
TEST(Refine, WhatDoublesHaveRoomForIsNotLeft) {
  std::mt19937_64 random(6);
  for (int run = 0; run < 100; ++run) {
    SCOPED_TRACE(run);
    constexpr double unit = 0x1p-29; // the last place of coordinates from 2^23 to 2^24
    PlanarGraph graph = square(1e7 - 500, 1e7 + 500);
    for (int i = 0; i < 9; ++i) {
      const auto draw = [&](int place, int from, unsigned range) {
        return 1e7 + unit * static_cast<double>(16000 * place + from + static_cast<int>(random() % range));
      };
      const auto first = static_cast<LocalIndex>(graph.vertices.size());
      graph.vertices.push_back({draw(i % 3, 0, 4000), draw(i / 3, 0, 12000)});
      graph.vertices.push_back({draw(i % 3, 8000, 4000), draw(i / 3, 0, 12000)});
      graph.segments.push_back({first, first + 1, 0});
    }
    const Refined result = refined(constrained(graph), 30);
    EXPECT_TRUE(result.left_subsegments.empty());
    for (const LeftTriangle &left : result.left_triangles)
      EXPECT_EQ(left.reason, LeftReason::small_input_angle);
  }
}

TEST(Refine, HugeAndTinyCoordinates) {
  const PlanarGraph graph = testing::random_segments(60, 4);
  const std::size_t expected = refined(constrained(graph), 25).mesh.region.size();
  for (const int exponent : {-800, -300, 300, 800}) {
    PlanarGraph other = graph;
    for (Point &p : other.vertices)
      p = {std::ldexp(p.x, exponent), std::ldexp(p.y, exponent)};
    const Domain domain = constrained(other);
    const Refined result = refined(domain, 25);
    expect_valid(result.mesh, domain.segments, 25);
    EXPECT_NEAR(static_cast<double>(result.mesh.region.size()), static_cast<double>(expected),
                0.1 * static_cast<double>(expected)); // shells at other powers of two
  }
}

/// What cannot be refined can still be triangulated and validated.
TEST(Refine, RefusesSizesThatDoublesDoNotHave) {
  PlanarGraph small = square(0, 0x1p-1000), mixed = square(0, 0x1p1000);
  mixed.vertices.insert(mixed.vertices.end(), {{0x1p-1000, 0x1p-1000}, {0x1p-999, 0x1p-1000}});
  mixed.segments.push_back({4, 5, 1});
  for (const PlanarGraph &graph : {small, mixed, square(0, 0x1p-1074)}) {
    const Domain domain = constrained(graph);
    expect_valid(domain.mesh, domain.segments);
    EXPECT_THROW(refined(domain, 25), Error);
  }
}

TEST(Refine, NothingAndNonsense) {
  EXPECT_EQ(refine({}, {}).mesh.vertices.size(), 0U);
  const Domain line = constrained({.vertices = {{0, 0}, {1, 0}, {2, 0}},
                                   .vertex_markers = {},
                                   .segments = {{0, 1, 1}},
                                   .is_line = {},
                                   .holes = {},
                                   .regions = {}});
  EXPECT_EQ(refined(line, 20).mesh.vertices.size(), 3U);
  for (const double degrees : {-1.0, 34.0, std::nan("")})
    EXPECT_THROW(refined(line, degrees), Error);
  EXPECT_THROW(refine({}, {}, {.max_area = -1}), Error);
}

} // namespace
} // namespace dovetail
