// Planar graphs from segments in any condition, against exact rationals: nothing crosses or touches but at
// ends, every segment is there as its chain, and no vertex has changed sides.
#include "dovetail/mesh/planarise.hpp"

#include "dovetail/geometry/intersection.hpp"

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <random>
#include <set>

namespace dovetail {
namespace {

int effort() { return std::getenv("DOVETAIL_FULL") != nullptr ? 100 : 1; }

struct Rational {
  mpq_class x, y;
};
Rational exact(Point p) { return {mpq_class(p.x), mpq_class(p.y)}; }
int side(Point a, Point b, Point c) {
  const Rational p = exact(a), q = exact(b), r = exact(c);
  return sgn((q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x));
}
bool strictly_inside_box(Point a, Point b, Point p) {
  return std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= p.y &&
         p.y <= std::max(a.y, b.y) && !(p == a) && !(p == b);
}
bool is_on(Point a, Point b, Point p) { return strictly_inside_box(a, b, p) && side(a, b, p) == 0; }

/// How often a closed curve goes round p, times two; p on it counts half.
int doubled_winding(const std::vector<Point> &curve, Point p) {
  int winding = 0;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const Point a = curve[i], b = curve[(i + 1) % curve.size()];
    const auto above = [&](Point q) { return q.y > p.y ? 1 : q.y < p.y ? -1 : 0; };
    const int turn = side(a, b, p);
    if ((above(b) - above(a)) * turn > 0)
      winding += above(b) - above(a);
  }
  return winding;
}

std::string text_of(const SegmentSet &set) {
  std::string text;
  for (const Segment &s : set.segments) {
    const Point a = set.vertices[static_cast<std::size_t>(s.from)],
                b = set.vertices[static_cast<std::size_t>(s.to)];
    char line[200];
    std::snprintf(line, sizeof line, "{%a, %a} {%a, %a}\n", a.x, a.y, b.x, b.y);
    text += line;
  }
  return text;
}

void expect_planar(const PlanarGraph &graph) {
  const auto point = [&](LocalIndex v) { return graph.vertices[static_cast<std::size_t>(v)]; };
  std::set<std::pair<double, double>> places;
  for (const Point p : graph.vertices)
    EXPECT_TRUE(places.emplace(p.x, p.y).second);
  std::set<std::pair<LocalIndex, LocalIndex>> ends;
  for (const Segment &s : graph.segments) {
    EXPECT_NE(s.from, s.to);
    EXPECT_TRUE(ends.insert(std::minmax(s.from, s.to)).second);
  }
  for (std::size_t i = 0; i < graph.segments.size(); ++i) {
    const Segment &s = graph.segments[i];
    for (std::size_t v = 0; v < graph.vertices.size(); ++v)
      EXPECT_FALSE(is_on(point(s.from), point(s.to), graph.vertices[v]));
    for (std::size_t j = 0; j < i; ++j) {
      const Segment &t = graph.segments[j];
      EXPECT_FALSE(
          side(point(s.from), point(s.to), point(t.from)) * side(point(s.from), point(s.to), point(t.to)) <
              0 &&
          side(point(t.from), point(t.to), point(s.from)) * side(point(t.from), point(t.to), point(s.to)) <
              0);
    }
  }
}

void expect_chains(const SegmentSet &given, const Planarised &result) {
  const PlanarGraph &graph = result.graph;
  std::map<std::pair<LocalIndex, LocalIndex>, std::size_t> uses;
  for (const Segment &s : graph.segments)
    uses[std::minmax(s.from, s.to)] = 0;
  ASSERT_EQ(result.chain_offsets.size(), given.segments.size() + 1);
  for (std::size_t s = 0; s < given.segments.size(); ++s) {
    const Point a = given.vertices[static_cast<std::size_t>(given.segments[s].from)];
    const Point b = given.vertices[static_cast<std::size_t>(given.segments[s].to)];
    std::vector<Point> curve;
    for (auto k = result.chain_offsets[s]; k < result.chain_offsets[s + 1]; ++k) {
      const LocalIndex v = result.chain_vertices[static_cast<std::size_t>(k)];
      curve.push_back(graph.vertices[static_cast<std::size_t>(v)]);
      if (k > result.chain_offsets[s]) {
        const auto found = uses.find(std::minmax(result.chain_vertices[static_cast<std::size_t>(k) - 1], v));
        ASSERT_NE(found, uses.end());
        ++found->second;
      }
      // Near the segment: rounding twice, in units of the last place of the largest coordinate.
      const double size = std::max({std::fabs(a.x), std::fabs(a.y), std::fabs(b.x), std::fabs(b.y)});
      const Rational p = exact(a), q = exact(b), r = exact(curve.back());
      const mpq_class doubled = (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
      const mpq_class squared = (q.x - p.x) * (q.x - p.x) + (q.y - p.y) * (q.y - p.y);
      const mpq_class most = mpq_class(4) * mpq_class(size) * mpq_class(0x1p-53);
      EXPECT_LE(doubled * doubled, most * most * squared);
    }
    ASSERT_FALSE(curve.empty());
    EXPECT_EQ(curve.front(), a);
    EXPECT_EQ(curve.back(), b);
    // No vertex that was given is between a segment and its chain, or on the segment without being on the
    // chain.
    const std::set<std::pair<double, double>> on_chain = [&] {
      std::set<std::pair<double, double>> places;
      for (const Point p : curve)
        places.emplace(p.x, p.y);
      return places;
    }();
    for (const Point p : given.vertices) {
      if (on_chain.contains({p.x, p.y}))
        continue;
      EXPECT_FALSE(is_on(a, b, p));
      EXPECT_EQ(doubled_winding(curve, p), 0);
    }
  }
  for (const auto &[ends, count] : uses)
    EXPECT_GT(count, 0U);
  for (std::size_t v = 0; v < given.vertices.size(); ++v)
    EXPECT_EQ(graph.vertices[static_cast<std::size_t>(result.vertex_of_input[v])], given.vertices[v]);
}

void expect_right(const SegmentSet &given) {
  SCOPED_TRACE(text_of(given));
  const Planarised result = planarise(given);
  expect_planar(result.graph);
  expect_chains(given, result);
}

void add(SegmentSet &set, Point a, Point b, std::int32_t marker = 0) {
  const auto first = static_cast<LocalIndex>(set.vertices.size());
  set.vertices.insert(set.vertices.end(), {a, b});
  set.segments.push_back({first, first + 1, marker});
}

TEST(Planarise, CrossingsOverlapsAndDuplicatesOnLattices) {
  std::mt19937_64 random(1);
  for (int run = 0; run < 60 * effort(); ++run) {
    SegmentSet set;
    const auto width = static_cast<int>(2 + random() % 7);
    const auto draw = [&] { return static_cast<double>(random() % static_cast<unsigned>(width)); };
    for (int i = 0; i < 12; ++i)
      add(set, {draw(), draw()}, {draw(), draw()}, static_cast<std::int32_t>(random() % 3));
    set.vertices.push_back({draw(), draw()});
    expect_right(set);
    if (HasFailure())
      return;
  }
}

/// A few units of the last place, where every rounded crossing moves far.
TEST(Planarise, WithinAFewUnitsOfTheLastPlace) {
  std::mt19937_64 random(2);
  for (int run = 0; run < 60 * effort(); ++run) {
    SegmentSet set;
    const double unit = 0x1p-52;
    const auto draw = [&](int width) {
      return 1 + unit * static_cast<double>(random() % static_cast<unsigned>(width));
    };
    const int width = run % 3 == 0 ? 4 : run % 3 == 1 ? 9 : 40;
    for (int i = 0; i < 9; ++i)
      add(set, {draw(width), draw(width)}, {draw(width), draw(width)});
    expect_right(set);
    if (HasFailure())
      return;
  }
}

TEST(Planarise, RandomSegmentsAndLargeOffsets) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform;
  for (const double offset : {0.0, 1e7, 1e15, -3e-300, 1e150})
    for (const double scale : {1.0, 1e-3}) {
      SegmentSet set;
      const auto draw = [&] { return offset + scale * (offset == 1e150 ? 1e150 : 1) * uniform(random); };
      for (int i = 0; i < 25; ++i)
        add(set, {draw(), draw()}, {draw(), draw()});
      expect_right(set);
    }
}

TEST(Planarise, CountsWhatItMends) {
  SegmentSet set;
  set.vertices = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 0}, {0, 0}, {1, 4}, {2, 5}, {5, 5}};
  set.segments = {{0, 1, 7}, {1, 2, 0}, {2, 3, 0}, {3, 5, 0}, {5, 0, 0}, {1, 0, 0}, {2, 6, 9}, {6, 7, 0}};
  const Planarised result = planarise(set);
  EXPECT_EQ(result.repairs.duplicate_vertices, 1);
  EXPECT_EQ(result.repairs.zero_length, 1);
  EXPECT_EQ(result.repairs.repeated, 1);
  EXPECT_EQ(result.repairs.overlapping, 1);
  EXPECT_EQ(result.repairs.junctions, 1);
  EXPECT_EQ(result.repairs.vertices_on_segments, 1); // once, although two segments lie there
  EXPECT_EQ(result.repairs.crossings, 0);
  EXPECT_EQ(result.repairs.hanging_ends, 1);
  EXPECT_EQ(result.repairs.lone_vertices, 1);
  EXPECT_EQ(result.given_vertices, 8);
  EXPECT_EQ(result.graph.segments.size(), 7U);
  for (const Segment &segment : result.graph.segments)
    if (std::min(segment.from, segment.to) == 0 && std::max(segment.from, segment.to) == 4) {
      EXPECT_EQ(segment.marker, 7);
    }
}

TEST(Planarise, NamesTheFirstCrossingThatItRefuses) {
  SegmentSet set;
  add(set, {0, 0}, {1, 0});
  add(set, {0, 1}, {3, 1});
  add(set, {2, 0}, {2, 2});
  add(set, {1, 0}, {1, -1});
  const Planarised result = planarise(set, CrossingRule::refuse);
  ASSERT_TRUE(result.refused);
  const SegmentCrossing refused = result.refused.value_or(SegmentCrossing{});
  EXPECT_EQ(refused.first, 1);
  EXPECT_EQ(refused.second, 2);
  EXPECT_EQ(refused.place, (Point{2, 1}));
  set.segments.pop_back();
  set.segments.pop_back();
  EXPECT_FALSE(planarise(set, CrossingRule::refuse).refused);
}

TEST(Planarise, BordersOfTwoPolygonsAndLinesDoNotCountForEvenOdd) {
  SegmentSet set;
  set.even_odd = true;
  set.vertices = {{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1, 1}, {0, 1}};
  set.segments = {{0, 1}, {1, 4}, {4, 5}, {5, 0}, {1, 2}, {2, 3}, {3, 4}, {4, 1}, {0, 4}};
  set.is_line = {0, 0, 0, 0, 0, 0, 0, 0, 1};
  const PlanarGraph graph = planarise(set).graph;
  ASSERT_EQ(graph.is_line.size(), graph.segments.size());
  for (std::size_t i = 0; i < graph.segments.size(); ++i) {
    const auto ends = std::minmax(graph.segments[i].from, graph.segments[i].to);
    EXPECT_EQ(graph.is_line[i] != 0, ends.first != 2 && ends.second == 4 && ends.first != 3) << i;
  }
}

/// A long segment across a hundred thousand, and a star: time, not result, is what could go wrong.
TEST(Planarise, LongSegmentsAndStars) {
  SegmentSet set;
  constexpr int many = 100000;
  for (int i = 0; i < many; ++i)
    add(set, {static_cast<double>(i), -1}, {static_cast<double>(i), 1});
  add(set, {-1, 0.25}, {many, 0.75});
  const Planarised comb = planarise(set);
  EXPECT_EQ(comb.repairs.crossings, many);
  EXPECT_EQ(comb.graph.segments.size(), static_cast<std::size_t>(3 * many + 1));

  SegmentSet star;
  star.vertices = {{0, 0}};
  for (int i = 0; i < many; ++i) {
    const double angle = 2 * 3.14159265358979 * i / many;
    star.vertices.push_back({std::cos(angle), std::sin(angle)});
    star.segments.push_back({0, i + 1});
  }
  EXPECT_EQ(planarise(star).repairs.crossings, 0);
}

TEST(LineIntersection, IsTheNearestDouble) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto nearest = [](const mpq_class &value, double found) {
    // The type is said: an expression of mpq_class refers to its parts, which end with the lambda.
    const auto distance = [&](double other) -> mpq_class { return abs(value - mpq_class(other)); };
    return distance(found) <= distance(std::nextafter(found, 1e308)) &&
           distance(found) <= distance(std::nextafter(found, -1e308));
  };
  for (int run = 0; run < 600; ++run) {
    std::array<Point, 4> p;
    const double scale = run % 3 == 0 ? 1 : run % 3 == 1 ? 0x1p-300 : 0x1p+300;
    for (Point &q : p) {
      q = {uniform(random), uniform(random)};
      if (run % 2 == 0)
        q = {std::round(100 * q.x), std::round(100 * q.y)};
      if (run % 5 == 0)
        q.y += 1e7;
      q = {scale * q.x, (run % 7 == 0 ? 0x1p-90 : 1) * scale * q.y};
    }
    const Rational a = exact(p[0]), b = exact(p[1]), c = exact(p[2]), d = exact(p[3]);
    const mpq_class below = (b.x - a.x) * (d.y - c.y) - (b.y - a.y) * (d.x - c.x);
    if (below == 0)
      continue;
    const mpq_class t = ((c.x - a.x) * (d.y - c.y) - (c.y - a.y) * (d.x - c.x)) / below;
    const Point found = line_intersection(p[0], p[1], p[2], p[3]);
    EXPECT_TRUE(nearest(a.x + t * (b.x - a.x), found.x));
    EXPECT_TRUE(nearest(a.y + t * (b.y - a.y), found.y));
    EXPECT_EQ(found, line_intersection(p[3], p[2], p[0], p[1]));
  }
}

} // namespace
} // namespace dovetail
