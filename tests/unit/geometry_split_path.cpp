// Split paths against Voronoi cells by brute force, in integers, on small sets full of ties.

#include "dovetail/geometry/split_path.hpp"
#include "support/rational_oracle.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <set>
#include <utility>

namespace dovetail {
namespace {

/// Across and along the lines, whatever the axis; small, so that 64 bits hold everything of degree 4.
using Site = oracle::Site<std::int64_t>;

class Random {
public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}
  std::int64_t integer(std::int64_t low, std::int64_t high) {
    return low + static_cast<std::int64_t>(bits_() % static_cast<std::uint64_t>(high - low + 1));
  }
  std::mt19937_64 &bits() { return bits_; }

private:
  std::mt19937_64 bits_;
};

/// Distinct sites in the total order. All coordinates even, so that lines may also run between sites.
std::vector<Site> random_sites(Random &random) {
  static constexpr std::array<std::pair<int, int>, 15> circle = {{{5, 0},
                                                                  {4, 3},
                                                                  {3, 4},
                                                                  {0, 5},
                                                                  {-3, 4},
                                                                  {-4, 3},
                                                                  {-5, 0},
                                                                  {-4, -3},
                                                                  {-3, -4},
                                                                  {0, -5},
                                                                  {3, -4},
                                                                  {4, -3},
                                                                  {0, 0},
                                                                  {1, 0},
                                                                  {0, 1}}};
  const std::int64_t count = random.integer(1, 14), kind = random.integer(0, 9);
  std::set<Site> sites;
  for (std::int64_t i = 0; i < count; ++i) {
    if (kind < 6) {
      static constexpr std::array<std::int64_t, 5> sizes = {1, 2, 3, 5, 8};
      const std::int64_t size = sizes[static_cast<std::size_t>(kind) % 5];
      sites.insert({2 * random.integer(0, size), 2 * random.integer(0, size)});
    } else if (kind < 8) {
      const auto [x, y] = circle[static_cast<std::size_t>(random.integer(0, 14))];
      sites.insert({2 * x, 2 * y});
    } else if (kind == 8) {
      sites.insert({2 * random.integer(-50, 50), 2 * random.integer(-50, 50)});
    } else {
      const std::int64_t t = random.integer(-9, 9); // all on a line
      sites.insert({4 * t, count % 3 == 0 ? 6 * t : count % 3 == 1 ? 0 : -2 * t});
    }
  }
  return {sites.begin(), sites.end()};
}

Point as_point(const Site &site, Axis axis) {
  const auto x = static_cast<double>(site.x), y = static_cast<double>(site.y);
  return axis == Axis::x ? Point{x, y} : Point{y, x};
}

SplitLine as_line(std::int64_t m, Axis axis) { return {static_cast<double>(m), axis}; }

Path numbered(const std::vector<Site> &sites, Axis axis) {
  Path result;
  for (const Site &site : sites) // a number that says which site it is
    result.push_back({as_point(site, axis), 1000 * site.x + site.y});
  return result;
}

/// A position on the line m + e as p/q + e r/q with q > 0: where two cells meet.
struct Position {
  std::int64_t p, r, q;
};

bool is_less(const Position &a, const Position &b) {
  return std::pair(a.p * b.q, a.r * b.q) < std::pair(b.p * a.q, b.r * a.q);
}

/// The cell of `site` meets the line m+ in more than nothing: from the definition of a Voronoi cell.
bool meets_line(const Site &site, const std::vector<Site> &all, std::int64_t m) {
  const auto lift = [m](const Site &s) { return (s.x - m) * (s.x - m) + s.y * s.y; };
  std::vector<Position> from, to;
  for (const Site &other : all) {
    // Nearer to `site`, at y: 2 y (other.y - site.y) <= lift(other) - lift(site) - 2 e (other.x - site.x)
    const std::int64_t dy = other.y - site.y, rise = lift(other) - lift(site),
                       shift = -2 * (other.x - site.x);
    if (dy > 0)
      to.push_back({rise, shift, 2 * dy});
    else if (dy < 0)
      from.push_back({-rise, -shift, -2 * dy});
    else if (std::pair(rise, shift) < std::pair<std::int64_t, std::int64_t>(0, 0))
      return false;
  }
  for (const Position &low : from)
    for (const Position &high : to)
      if (!is_less(low, high))
        return false;
  return true;
}

std::vector<Site> brute_path(const std::vector<Site> &sites, std::int64_t m) {
  std::vector<Site> path;
  for (const Site &site : sites)
    if (meets_line(site, sites, m))
      path.push_back(site);
  std::sort(path.begin(), path.end(), [](const Site &a, const Site &b) { return a.y < b.y; });
  return path;
}

std::vector<std::int64_t> lines_of(const std::vector<Site> &sites) {
  std::set<std::int64_t> lines = {sites.front().x - 3, sites.back().x + 3};
  for (const Site &site : sites)
    lines.insert({site.x, site.x + 1});
  return {lines.begin(), lines.end()};
}

/// Calls check(sites, random) on thousands of small sets.
template <class Check> void on_small_sets(std::uint64_t seed, Check check) {
  Random random(seed);
  for (int round = 0; round < 4000 && !testing::Test::HasFatalFailure(); ++round)
    check(random_sites(random), random);
}

TEST(SplitPath, is_the_sites_whose_cells_meet_the_line) {
  on_small_sets(1, [](const std::vector<Site> &sites, Random &random) {
    for (const std::int64_t m : lines_of(sites))
      for (const Axis axis : {Axis::x, Axis::y}) {
        Path shuffled = numbered(sites, axis);
        shuffled.push_back(shuffled.front()); // twice counts once
        std::shuffle(shuffled.begin(), shuffled.end(), random.bits());
        ASSERT_EQ(split_path(shuffled, as_line(m, axis)), numbered(brute_path(sites, m), axis));
      }
  });
}

bool is_delaunay_edge(const Site &a, const Site &b, const std::vector<Site> &sites, Axis axis) {
  const auto original = [axis](const Site &s) { return axis == Axis::x ? s : Site{s.y, s.x}; };
  bool collinear = true, beside = false;
  for (const Site &c : sites) {
    std::array<Site, 4> corners = {original(a), original(b), original(c), {}};
    const Sign turn = oracle::orientation(corners[0], corners[1], corners[2]);
    if (turn == Sign::zero)
      continue;
    collinear = false;
    if (turn == Sign::negative)
      std::swap(corners[0], corners[1]);
    beside = beside || std::ranges::none_of(sites, [&](const Site &d) {
               corners[3] = original(d);
               return !(d == a) && !(d == b) && !(d == c) && oracle::in_circle(corners) == Sign::positive;
             });
  }
  return collinear || beside;
}

TEST(SplitPath, is_a_chain_of_delaunay_edges) {
  on_small_sets(2, [](const std::vector<Site> &sites, Random &) {
    for (const std::int64_t m : lines_of(sites)) {
      const std::vector<Site> path = brute_path(sites, m);
      for (std::size_t i = 0; i + 1 < path.size(); ++i)
        for (const Axis axis : {Axis::x, Axis::y})
          ASSERT_TRUE(is_delaunay_edge(path[i], path[i + 1], sites, axis));
    }
  });
}

TEST(SplitPath, has_all_sites_on_the_line) {
  on_small_sets(3, [](const std::vector<Site> &sites, Random &) {
    for (const std::int64_t m : lines_of(sites)) {
      const Path path = split_path(numbered(sites, Axis::x), as_line(m, Axis::x));
      const auto on_line = [m](double x) { return x == static_cast<double>(m); };
      ASSERT_EQ(std::ranges::count_if(path, on_line, [](const PathSite &s) { return s.point.x; }),
                std::ranges::count(sites, m, &Site::x));
    }
  });
}

std::vector<Site> between(const std::vector<Site> &sites, std::int64_t low, std::int64_t high) {
  std::vector<Site> result;
  std::ranges::copy_if(sites, std::back_inserter(result),
                       [=](const Site &s) { return s.x >= low && s.x <= high; });
  return result;
}

/// Between two lines, a slab's own sites and its two paths have the paths of all sites.
TEST(SplitPath, is_the_same_from_a_slab_and_its_two_paths) {
  on_small_sets(4, [](const std::vector<Site> &sites, Random &random) {
    const std::vector<std::int64_t> lines = lines_of(sites);
    const auto last = static_cast<std::int64_t>(lines.size()) - 1;
    const auto i = random.integer(0, last), j = random.integer(i, last);
    const std::int64_t low = lines[static_cast<std::size_t>(i)], high = lines[static_cast<std::size_t>(j)];
    for (const Axis axis : {Axis::x, Axis::y}) {
      Path known = numbered(between(sites, low, high), axis);
      for (const std::int64_t m : {low, high})
        std::ranges::copy(numbered(brute_path(sites, m), axis), std::back_inserter(known));
      for (std::int64_t m = low; m <= high; ++m)
        ASSERT_EQ(split_path(known, as_line(m, axis)), numbered(brute_path(sites, m), axis));
    }
  });
}

/// Slabs of equal count in the total order, empty ones included, with the lines between them.
struct Slabs {
  std::vector<std::vector<Site>> own;
  std::vector<std::int64_t> lines;
};

Slabs cut(const std::vector<Site> &sites, std::size_t count) {
  Slabs slabs;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t begin = sites.size() * k / count, end = sites.size() * (k + 1) / count;
    slabs.own.emplace_back(sites.begin() + static_cast<std::ptrdiff_t>(begin),
                           sites.begin() + static_cast<std::ptrdiff_t>(end));
    if (k + 1 < count)
      slabs.lines.push_back(sites[std::max<std::size_t>(end, 1) - 1].x);
  }
  return slabs;
}

Path own_hull_of(const std::vector<Site> &own, std::int64_t m, Axis axis) {
  std::vector<Point> points;
  points.reserve(own.size());
  for (const Site &site : own)
    points.push_back(as_point(site, axis));
  Path hull = own_hull(points, 500, as_line(m, axis));
  const Path names = numbered(own, axis);
  for (PathSite &site : hull) {
    const PathSite &named = names.at(static_cast<std::size_t>(site.number - 500));
    EXPECT_EQ(named.point, site.point);
    site = named;
  }
  return hull;
}

/// Every path follows from the own hulls of all slabs by a forward and a backward scan.
TEST(SplitPath, follows_from_own_hulls_by_scanning) {
  on_small_sets(5, [](const std::vector<Site> &sites, Random &random) {
    const Slabs slabs = cut(sites, static_cast<std::size_t>(random.integer(2, 6)));
    for (const Axis axis : {Axis::x, Axis::y}) {
      std::vector<Path> left, right(slabs.lines.size());
      for (std::size_t k = 0; k < slabs.lines.size(); ++k) {
        const Path hull = own_hull_of(slabs.own[k], slabs.lines[k], axis);
        left.push_back(hull_of_both(hull, k > 0 ? left.back() : Path{}, as_line(slabs.lines[k], axis)));
      }
      for (std::size_t k = slabs.lines.size(); k-- > 0;) {
        const Path hull = own_hull_of(slabs.own[k + 1], slabs.lines[k], axis);
        const Path beyond = k + 1 < right.size() ? right[k + 1] : Path{};
        right[k] = hull_of_both(hull, beyond, as_line(slabs.lines[k], axis));
        ASSERT_EQ(hull_of_both(left[k], right[k], as_line(slabs.lines[k], axis)),
                  numbered(brute_path(sites, slabs.lines[k]), axis));
      }
    }
  });
}

/// Nothing but own hulls is ever needed of a slab, for any line at or beyond its border.
TEST(SplitPath, has_no_site_of_a_slab_off_its_own_hull) {
  on_small_sets(6, [](const std::vector<Site> &sites, Random &random) {
    const Slabs slabs = cut(sites, static_cast<std::size_t>(random.integer(2, 6)));
    for (std::size_t line = 0; line < slabs.lines.size(); ++line) {
      const std::vector<Site> path = brute_path(sites, slabs.lines[line]);
      for (std::size_t k = 0; k < slabs.own.size(); ++k) {
        const Path hull = own_hull_of(slabs.own[k], slabs.lines[line >= k ? k : k - 1], Axis::x);
        for (const Site &site : path)
          if (std::ranges::find(slabs.own[k], site) != slabs.own[k].end()) {
            ASSERT_NE(std::ranges::find(hull, as_point(site, Axis::x), &PathSite::point), hull.end());
          }
      }
    }
  });
}

/// By the rule itself: inside or on the circle of its pair, or beyond the ends.
bool can_be_on_path(const Site &p, const std::vector<Site> &approximate, std::int64_t m) {
  if (approximate.size() < 2 || p.y < approximate.front().y || p.y > approximate.back().y)
    return true;
  for (std::size_t i = 0; i + 1 < approximate.size(); ++i) {
    const Site &a = approximate[i], &b = approximate[i + 1];
    if (a.y <= p.y && p.y <= b.y && oracle::hull_polynomial(a, p, b, m) >= 0)
      return true;
  }
  return false;
}

TEST(PathFilter, lets_through_what_the_path_needs_and_little_else) {
  int rejected = 0, exactly = 0, too_many = 0;
  on_small_sets(7, [&](const std::vector<Site> &sites, Random &random) {
    std::vector<Site> some = sites;
    std::shuffle(some.begin(), some.end(), random.bits());
    some.resize(std::max<std::size_t>(1, some.size() / 3));
    std::sort(some.begin(), some.end());
    for (const std::int64_t m : lines_of(sites))
      for (const Axis axis : {Axis::x, Axis::y}) {
        const std::vector<Site> approximate = brute_path(some, m);
        const PathFilter filter(numbered(approximate, axis), as_line(m, axis));
        Path kept = numbered(approximate, axis);
        for (const Site &site : sites) {
          const bool passes = filter.lets_through(as_point(site, axis));
          const bool needed = can_be_on_path(site, approximate, m);
          ASSERT_TRUE(passes || !needed);
          rejected += !passes;
          exactly += !needed;
          too_many += passes && !needed;
          if (passes)
            kept.push_back(numbered({site}, axis).front());
        }
        ASSERT_EQ(split_path(kept, as_line(m, axis)), numbered(brute_path(sites, m), axis));
      }
  });
  EXPECT_GT(rejected, 10'000);
  EXPECT_EQ(rejected, exactly) << too_many << " too many pass: small integers leave no room for rounding";
}

} // namespace
} // namespace dovetail
