/// Constrained triangulations against the definition, by brute force in integers.
#include "dovetail/mesh/constrain.hpp"

#include "dovetail/base/error.hpp"
#include "dovetail/mesh/checksum.hpp"
#include "dovetail/mesh/validate_domain.hpp"
#include "support/domain_families.hpp"
#include "support/rational_oracle.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <numeric>
#include <random>
#include <set>

namespace dovetail {
namespace {

using Site = oracle::Site<std::int64_t>;
using oracle::orientation;

constexpr std::size_t index(LocalIndex i) { return static_cast<std::size_t>(i); }

Site site_of(Point p, std::int64_t factor = 1) {
  return {factor * static_cast<std::int64_t>(p.x), factor * static_cast<std::int64_t>(p.y)};
}

bool strictly_between(const Site &a, const Site &b, const Site &p) {
  return orientation(a, b, p) == Sign::zero && ((a < p && p < b) || (b < p && p < a));
}

/// Whether ab and cd have more in common than an end of both.
bool collide(const Site &a, const Site &b, const Site &c, const Site &d) {
  if ((a == c && b == d) || (a == d && b == c))
    return true;
  return strictly_between(a, b, c) || strictly_between(a, b, d) || strictly_between(c, d, a) ||
         strictly_between(c, d, b) ||
         (orientation(a, b, c) * orientation(a, b, d) == Sign::negative &&
          orientation(c, d, a) * orientation(c, d, b) == Sign::negative);
}

/// Distinct lattice points, and as many segments among them as chance and order allow.
PlanarGraph lattice_graph(std::mt19937_64 &random) {
  PlanarGraph graph;
  const auto count = 3 + random() % 28, width = 2 + random() % 10;
  std::set<std::pair<std::uint64_t, std::uint64_t>> taken;
  for (std::uint64_t i = 0; i < count; ++i)
    if (const std::pair place(random() % width, random() % width); taken.insert(place).second)
      graph.vertices.push_back({static_cast<double>(place.first), static_cast<double>(place.second)});
  const std::size_t n = graph.vertices.size();
  for (std::size_t tries = random() % (4 * n); tries > 0; --tries) {
    const std::size_t from = random() % n, to = random() % n;
    const Site a = site_of(graph.vertices[from]), b = site_of(graph.vertices[to]);
    const auto free_of_segment = [&](const Segment &s) {
      return !collide(a, b, site_of(graph.vertices[index(s.from)]), site_of(graph.vertices[index(s.to)]));
    };
    const auto free_of_vertex = [&](Point p) { return !strictly_between(a, b, site_of(p)); };
    if (from != to && std::ranges::all_of(graph.segments, free_of_segment) &&
        std::ranges::all_of(graph.vertices, free_of_vertex))
      graph.segments.push_back({static_cast<LocalIndex>(from), static_cast<LocalIndex>(to), 1});
  }
  return graph;
}

/// Whether p sees q, which is a vertex, past all segments. Coordinates three times those of the graph.
bool sees(const Site &p, const Site &q, const PlanarGraph &graph) {
  return std::ranges::none_of(graph.segments, [&](const Segment &s) {
    const Site a = site_of(graph.vertices[index(s.from)], 3), b = site_of(graph.vertices[index(s.to)], 3);
    if (a == q || b == q)
      return strictly_between(p, q, a == q ? b : a);
    return collide(p, q, a, b) || strictly_between(a, b, p);
  });
}

/// No vertex that is visible from the middle of a triangle is in its circle.
void expect_constrained_delaunay(const PlanarGraph &graph, const DomainMesh &mesh) {
  for (std::size_t t = 0; t < mesh.triangles.corners.size(); t += 3) {
    std::array<Site, 3> corner;
    for (std::size_t i = 0; i < 3; ++i)
      corner[i] = site_of(graph.vertices[index(mesh.triangles.corners[t + i])]);
    ASSERT_EQ(orientation(corner[0], corner[1], corner[2]), Sign::positive);
    const Site middle{corner[0].x + corner[1].x + corner[2].x, corner[0].y + corner[1].y + corner[2].y};
    for (const Point &p : graph.vertices) {
      const Site d = site_of(p);
      if (std::ranges::find(corner, d) != corner.end() || !sees(middle, site_of(p, 3), graph))
        continue;
      ASSERT_NE(oracle::in_circle<std::int64_t>({corner[0], corner[1], corner[2], d}), Sign::positive);
    }
  }
}

/// Twice the area of what the mesh covers, exactly.
std::int64_t doubled_area(const DomainMesh &mesh) {
  std::int64_t sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.corners.size(); t += 3) {
    const auto at = [&](std::size_t i) {
      return site_of(mesh.vertices[index(mesh.triangles.corners[t + i])]);
    };
    const Site a = at(0), b = at(1), c = at(2);
    sum += (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  }
  return sum;
}

std::set<std::pair<LocalIndex, LocalIndex>> edges_of_segments(const DomainMesh &mesh) {
  std::set<std::pair<LocalIndex, LocalIndex>> edges;
  for (std::size_t side = 0; side < mesh.segment_of_side.size(); ++side)
    if (mesh.segment_of_side[side] != none) {
      const std::size_t base = side - side % 3;
      edges.insert(std::minmax(mesh.triangles.corners[base + (side + 1) % 3],
                               mesh.triangles.corners[base + (side + 2) % 3]));
    }
  return edges;
}

std::string faults_of(const DomainReport &report) {
  std::string text;
  for (const DomainFault &fault : report.first_faults)
    text += std::string(name_of(fault.kind)) + ": " + fault.text + "\n";
  return text;
}

constexpr ConstrainOptions keep_hull{.outline = Outline::convex_hull};

TEST(Constrain, SmallLatticesByBruteForce) {
  std::mt19937_64 random(1);
  int crossed = 0;
  for (int round = 0; round < 3000; ++round) {
    const PlanarGraph graph = lattice_graph(random);
    const Constrained result = constrain(graph, keep_hull);
    if (result.mesh.triangles.triangle_count() == 0)
      continue;
    std::vector<Segment> segments = graph.segments;
    segments.insert(segments.end(), result.hull_segments.begin(), result.hull_segments.end());
    const DomainReport report = validate_domain(result.mesh, segments);
    ASSERT_TRUE(report.valid()) << faults_of(report);
    ASSERT_EQ(report.missing_segments, 0);
    expect_constrained_delaunay(graph, result.mesh);
    std::set<std::pair<LocalIndex, LocalIndex>> expected;
    for (const Segment &s : segments)
      expected.insert(std::minmax(s.from, s.to));
    ASSERT_EQ(edges_of_segments(result.mesh), expected);
    PlanarGraph bare = graph;
    bare.segments.clear();
    crossed += checksum_of_triangles(graph.vertices, constrain(bare, keep_hull).mesh.triangles.corners) !=
               checksum_of_triangles(graph.vertices, result.mesh.triangles.corners);
  }
  EXPECT_GT(crossed, 1000); // otherwise the segments were no work
}

TEST(Constrain, OrderLeavesNoTrace) {
  std::mt19937_64 random(2);
  for (const auto &[name, graph] : testing::domain_families()) {
    PlanarGraph other = graph;
    std::vector<LocalIndex> order(graph.vertices.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::shuffle(order, random);
    for (std::size_t i = 0; i < order.size(); ++i)
      other.vertices[index(order[i])] = graph.vertices[i];
    std::ranges::shuffle(other.segments, random);
    for (Segment &s : other.segments) {
      s = {order[index(s.from)], order[index(s.to)], s.marker};
      if (random() % 2 == 0)
        std::swap(s.from, s.to);
    }
    const DomainMesh a = constrain(graph).mesh, b = constrain(other).mesh;
    EXPECT_EQ(checksum_of_triangles(a.vertices, a.triangles.corners),
              checksum_of_triangles(b.vertices, b.triangles.corners))
        << name;
    EXPECT_GT(a.triangles.triangle_count(), 0) << name;
  }
}

/// A closed outline around a lattice, with vertices everywhere.
TEST(Constrain, AreaOfStarShapedPolygons) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 300; ++round) {
    PlanarGraph graph;
    const int corners = 3 + static_cast<int>(random() % 40);
    std::int64_t area = 0;
    for (int i = 0; i < corners; ++i) {
      const double angle = 6.283185307179586 * i / corners,
                   radius = 20 + static_cast<double>(random() % 1000);
      graph.vertices.push_back({std::round(radius * std::cos(angle)), std::round(radius * std::sin(angle))});
    }
    for (int i = 0; i < corners; ++i) {
      const Site a = site_of(graph.vertices[index(i)]), b = site_of(graph.vertices[index((i + 1) % corners)]);
      area += a.x * b.y - a.y * b.x;
      graph.segments.push_back({i, (i + 1) % corners, 5});
    }
    const auto crossing = [&](const Segment &s, const Segment &t) {
      return &s != &t &&
             collide(site_of(graph.vertices[index(s.from)]), site_of(graph.vertices[index(s.to)]),
                     site_of(graph.vertices[index(t.from)]), site_of(graph.vertices[index(t.to)]));
    };
    if (std::ranges::any_of(graph.segments, [&](const Segment &s) {
          return std::ranges::any_of(graph.segments, [&](const Segment &t) { return crossing(s, t); });
        }))
      continue; // rounded onto each other
    const Constrained result = constrain(graph);
    EXPECT_EQ(doubled_area(result.mesh), area);
    EXPECT_EQ(result.mesh.triangles.triangle_count(), corners - 2);
    EXPECT_EQ(result.mesh.vertex_markers, std::vector<std::int32_t>(index(corners), 5));
  }
}

void add_square(PlanarGraph &graph, double low, double high) {
  const auto first = static_cast<LocalIndex>(graph.vertices.size());
  for (const Point p : {Point{low, low}, {high, low}, {high, high}, {low, high}})
    graph.vertices.push_back(p);
  for (LocalIndex i = 0; i < 4; ++i)
    graph.segments.push_back({first + i, first + (i + 1) % 4, 1});
}

TEST(Constrain, HolesRegionsAndNesting) {
  PlanarGraph graph;
  for (int i = 0; i < 4; ++i)
    add_square(graph, i, 20 - i);
  const auto covered = [&] { return doubled_area(constrain(graph).mesh) / 2; };
  EXPECT_EQ(covered(), 400);
  graph.even_odd = true;
  EXPECT_EQ(covered(), 400 - 324 + 256 - 196);
  graph.even_odd = false;
  graph.holes = {{10, 10}, {10, 0.5}};
  EXPECT_EQ(covered(), 324 - 196);
  graph.regions = {{{10, 1.5}, 1.5, 0}, {{1.5, 10}, 0, 0}, {{2.5, 9}, 0, 0}, {{10, 10}, 0, 0},
                   {{30, 0}, 0, 0},     {{2, 9}, 0, 0},    {{2, 2}, 0, 0}};
  graph.holes.push_back({1, 5});
  graph.holes.push_back({-1, 5});
  const Constrained result = constrain(graph);
  const auto faults = [](const std::vector<StraySeed> &seeds) {
    std::map<LocalIndex, SeedFault> by_seed;
    for (const StraySeed &seed : seeds)
      by_seed[seed.seed] = seed.fault;
    return by_seed;
  };
  EXPECT_EQ(faults(result.stray_holes),
            (std::map<LocalIndex, SeedFault>{{2, SeedFault::on_segment}, {3, SeedFault::outside}}));
  EXPECT_EQ(faults(result.stray_regions), (std::map<LocalIndex, SeedFault>{{1, SeedFault::taken},
                                                                           {3, SeedFault::outside},
                                                                           {4, SeedFault::outside},
                                                                           {5, SeedFault::on_segment},
                                                                           {6, SeedFault::on_segment}}));
  EXPECT_EQ(std::ranges::count(result.mesh.region, 0) + std::ranges::count(result.mesh.region, 2),
            result.mesh.triangles.triangle_count());
}

TEST(Constrain, WithoutOutlineNothingIsLeft) {
  PlanarGraph graph;
  add_square(graph, 0, 4);
  graph.segments.pop_back();
  const Constrained result = constrain(graph);
  EXPECT_TRUE(result.nothing_left);
  EXPECT_EQ(result.mesh.triangles.triangle_count(), 0);
  const Constrained kept = constrain(graph, {.outline = Outline::convex_hull, .hull_marker = 9});
  EXPECT_FALSE(kept.nothing_left);
  EXPECT_EQ(doubled_area(kept.mesh), 32);
  EXPECT_EQ(kept.hull_segments, (std::vector<Segment>{{3, 0, 9}}));
}

TEST(Constrain, TooLittleForATriangle) {
  EXPECT_EQ(constrain({}).mesh.triangles.triangle_count(), 0);
  PlanarGraph line;
  line.vertices = {{0, 0}, {1, 1}, {2, 2}};
  line.segments = {{0, 1, 1}, {1, 2, 1}};
  line.holes = {{1, 1}};
  const Constrained result = constrain(line);
  EXPECT_FALSE(result.nothing_left);
  EXPECT_EQ(result.stray_holes.size(), 1U);
}

std::string message_of(const PlanarGraph &graph) {
  try {
    constrain(graph);
  } catch (const Error &error) {
    return std::string(error.what());
  }
  return {};
}

TEST(Constrain, GraphsThatAreNotInOrder) {
  PlanarGraph graph;
  add_square(graph, 0, 4);
  const auto with = [&](std::vector<Segment> segments) {
    PlanarGraph more = graph;
    more.vertices.push_back({2, 2});
    more.segments.insert(more.segments.end(), segments.begin(), segments.end());
    return message_of(more);
  };
  EXPECT_EQ(with({{0, 4, 1}}), "");
  EXPECT_NE(with({{0, 2, 1}}).find("vertex 4 lies on it"), std::string::npos);
  EXPECT_NE(with({{0, 9, 1}}).find("segment 4"), std::string::npos);
  EXPECT_NE(with({{0, 0, 1}}).find("segment 4"), std::string::npos);
  EXPECT_NE(with({{1, 0, 1}}).find("segment 0 has the same ends"), std::string::npos);
  PlanarGraph cross;
  cross.vertices = {{0, 0}, {4, 0}, {4, 3}, {0, 4}};
  cross.segments = {{0, 2, 1}, {1, 3, 1}};
  EXPECT_NE(message_of(cross).find("crosses it"), std::string::npos);
}

/// Quadratic time would be minutes.
TEST(Constrain, LongSegmentsCrossManyTriangles) {
  constexpr LocalIndex n = 100'000;
  PlanarGraph chord = testing::regular_polygon(n);
  chord.segments.push_back({0, n / 2, 1});
  EXPECT_EQ(constrain(chord).mesh.triangles.triangle_count(), n - 2);

  PlanarGraph arcs; // two convex chains that nearly touch the segment between them
  for (LocalIndex i = 0; i < n; ++i) {
    const double x = static_cast<double>(i) / n;
    arcs.vertices.push_back({x, i % 2 == 0 ? x * x + 1e-9 : -x * x - 1e-9});
  }
  arcs.vertices.insert(arcs.vertices.end(), {{-1, 0}, {2, 0}});
  arcs.segments = {{n, n + 1, 1}};
  const Constrained result = constrain(arcs, keep_hull);
  std::vector<Segment> segments = arcs.segments;
  segments.insert(segments.end(), result.hull_segments.begin(), result.hull_segments.end());
  EXPECT_TRUE(validate_domain(result.mesh, segments).valid());
}

} // namespace
} // namespace dovetail
