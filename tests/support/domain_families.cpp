#include "support/domain_families.hpp"

#include "dovetail/geometry/predicates.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace dovetail::testing {
namespace {

constexpr double pi = std::numbers::pi;

LocalIndex add(PlanarGraph &graph, Point p) {
  graph.vertices.push_back(p);
  return static_cast<LocalIndex>(graph.vertices.size() - 1);
}

void add_segment(PlanarGraph &graph, LocalIndex from, LocalIndex to) {
  graph.segments.push_back({from, to, static_cast<std::int32_t>(1 + graph.segments.size() % 7)});
}

void add_polygon(PlanarGraph &graph, const std::vector<Point> &corners) {
  const auto first = static_cast<LocalIndex>(graph.vertices.size());
  const auto count = static_cast<LocalIndex>(corners.size());
  for (const Point &p : corners)
    add(graph, p);
  for (LocalIndex i = 0; i < count; ++i)
    add_segment(graph, first + i, first + (i + 1) % count);
}

void add_square(PlanarGraph &graph, double low, double high) {
  add_polygon(graph, {{low, low}, {high, low}, {high, high}, {low, high}});
}

Point on_circle(double radius, double turn) {
  return {radius * std::cos(2 * pi * turn), radius * std::sin(2 * pi * turn)};
}

/// Whether segments ab and cd have more in common than an end of both.
bool collide(Point a, Point b, Point c, Point d) {
  const auto between = [](Point p, Point q, Point r) {
    return orientation(p, q, r) == Sign::zero && std::min(p.x, q.x) <= r.x && r.x <= std::max(p.x, q.x) &&
           std::min(p.y, q.y) <= r.y && r.y <= std::max(p.y, q.y) && r != p && r != q;
  };
  if (between(a, b, c) || between(a, b, d) || between(c, d, a) || between(c, d, b))
    return true;
  if ((a == c && b == d) || (a == d && b == c))
    return true;
  return orientation(a, b, c) * orientation(a, b, d) == Sign::negative &&
         orientation(c, d, a) * orientation(c, d, b) == Sign::negative;
}

} // namespace

PlanarGraph comb(int teeth, double gap) {
  PlanarGraph graph;
  std::vector<Point> corners{{0, -0.1}, {1, -0.1}};
  for (int i = teeth - 1; i >= 0; --i) {
    const double left = static_cast<double>(i) / teeth, right = static_cast<double>(i + 1) / teeth - gap;
    corners.insert(corners.end(), {{right, 0}, {right, 1}, {left, 1}, {left, 0}});
  }
  corners.pop_back();
  corners.erase(corners.begin() + 2);
  corners[1] = {corners[2].x, -0.1};
  corners[0] = {0, -0.1};
  add_polygon(graph, corners);
  return graph;
}

PlanarGraph star(int spikes, double degrees) {
  PlanarGraph graph;
  std::vector<Point> corners;
  // The tip at distance 1 sees the two inner vertices beside it, half a step away, under the angle.
  const double half_step = pi / spikes, half_angle = degrees * pi / 360;
  const double inner = std::sin(half_angle) / std::sin(pi - half_step - half_angle);
  for (int i = 0; i < spikes; ++i) {
    corners.push_back(on_circle(1, static_cast<double>(i) / spikes));
    corners.push_back(on_circle(inner, (i + 0.5) / spikes));
  }
  add_polygon(graph, corners);
  return graph;
}

PlanarGraph fan(int segments, double degrees) {
  PlanarGraph graph;
  add_square(graph, -2, 2);
  const LocalIndex centre = add(graph, {0, 0});
  for (int i = 0; i < segments; ++i) {
    const double turn = i == 0 ? 0.011 : 0.011 + degrees / 360 + 0.9 * (i - 1) / segments;
    add_segment(graph, centre, add(graph, on_circle(1 + 0.3 * (i % 3), turn)));
  }
  return graph;
}

PlanarGraph slits(int pairs, double gap) {
  PlanarGraph graph;
  add_square(graph, 0, 1);
  for (int i = 0; i < pairs; ++i) {
    const double y = (i + 0.5) / pairs;
    for (const double shift : {0.0, gap})
      add_segment(graph, add(graph, {0.2 + 3 * shift, y + shift}), add(graph, {0.8, y + 1.5 * shift}));
  }
  return graph;
}

PlanarGraph nested(int depth, double gap) {
  PlanarGraph graph;
  graph.even_odd = true;
  for (int i = 0; i < depth; ++i) {
    const int pair = i / 2;
    const double half = 1 - 0.8 * pair / depth - (i % 2) * gap;
    add_square(graph, -half, half);
  }
  return graph;
}

PlanarGraph regular_polygon(int sides) {
  PlanarGraph graph;
  std::vector<Point> corners;
  for (int i = 0; i < sides; ++i)
    corners.push_back(on_circle(1, static_cast<double>(i) / sides));
  add_polygon(graph, corners);
  return graph;
}

PlanarGraph random_segments(int tries, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&] { return 0.02 + 0.96 * static_cast<double>(random() >> 11) * 0x1p-53; };
  PlanarGraph graph;
  add_square(graph, 0, 1);
  for (int i = 0; i < tries; ++i) {
    const auto end = [&]() -> Point {
      if (random() % 2 == 0)
        return graph.vertices[random() % graph.vertices.size()];
      return {uniform(), uniform()};
    };
    const Point a = end(), b = end();
    const auto is_free = [&](const Segment &s) {
      return !collide(a, b, graph.vertices[static_cast<std::size_t>(s.from)],
                      graph.vertices[static_cast<std::size_t>(s.to)]);
    };
    const auto passes = [&](Point p) { return p == a || p == b || !collide(a, b, p, p); };
    if (a == b || !std::ranges::all_of(graph.segments, is_free) ||
        !std::ranges::all_of(graph.vertices, passes))
      continue;
    const auto number = [&](Point p) {
      const auto found = std::ranges::find(graph.vertices, p);
      return found == graph.vertices.end() ? add(graph, p)
                                           : static_cast<LocalIndex>(found - graph.vertices.begin());
    };
    const LocalIndex from = number(a), to = number(b);
    add_segment(graph, from, to);
  }
  return graph;
}

PlanarGraph shifted(PlanarGraph graph, double by) {
  for (std::vector<Point> *points : {&graph.vertices, &graph.holes})
    for (Point &p : *points)
      p = {p.x + by, p.y + by};
  return graph;
}

std::vector<NamedGraph> domain_families() {
  std::vector<NamedGraph> result{
      {"comb", comb(20, 0.01)},
      {"comb with hairlines", comb(10, 0.0005)},
      {"slits a thousandth apart", slits(10, 0.001)},
      {"slits a ten-thousandth apart", slits(1, 1e-4)},
      {"nested holes", nested(12, 0.01)},
      {"nested holes, nearly touching", nested(4, 1e-3)},
      {"thousand-gon", regular_polygon(1000)},
      {"triangle", regular_polygon(3)},
  };
  for (const double degrees : {30.0, 10.0, 1.0, 0.1}) {
    result.push_back({"star of " + std::to_string(degrees), star(7, degrees)});
    result.push_back({"fan of " + std::to_string(degrees), fan(9, degrees)});
  }
  for (std::uint64_t seed = 1; seed <= 5; ++seed)
    result.push_back({"random segments " + std::to_string(seed), random_segments(200, seed)});
  const std::size_t near = result.size();
  for (std::size_t i = 0; i < near; ++i) {
    NamedGraph far = result[i];
    for (Point &p : far.graph.vertices)
      p = {1000 * p.x, 1000 * p.y};
    result.push_back({far.name + ", ten million away", shifted(far.graph, 1e7)});
  }
  return result;
}

} // namespace dovetail::testing
