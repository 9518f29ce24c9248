// Hulls of many sites, where strips, batches and filters are at work, against the plain path of all of them;
// and the filter against the rule it stands for in rational arithmetic, at every magnitude.

#include "dovetail/geometry/distributions.hpp"
#include "dovetail/geometry/split_path.hpp"
#include "support/rational_oracle.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <random>

namespace dovetail {
namespace {

class Random {
public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}
  int integer(int low, int high) {
    return low + static_cast<int>(bits_() % static_cast<std::uint64_t>(high - low + 1));
  }
  double uniform() { return static_cast<double>(bits_() >> 11) * 0x1p-53; }
  double any_magnitude() {
    const double value = std::ldexp(0.5 + uniform(), integer(-1070, 1023));
    return integer(0, 1) != 0 ? value : -value;
  }

private:
  std::mt19937_64 bits_;
};

std::vector<Point> in_total_order(std::vector<Point> sites, Axis axis) {
  std::sort(sites.begin(), sites.end(), TotalOrder{axis});
  sites.erase(std::unique(sites.begin(), sites.end()), sites.end());
  return sites;
}

std::vector<PathSite> numbered(std::span<const Point> sites) {
  std::vector<PathSite> result;
  for (const Point p : sites)
    result.push_back({p, 77 + static_cast<GlobalIndex>(result.size())});
  return result;
}

/// At the border, beyond it on the other side, and among the sites.
void expect_plain_hulls(const std::vector<Point> &points, const std::string &name) {
  for (const Axis axis : {Axis::x, Axis::y}) {
    const std::vector<Point> sites = in_total_order(points, axis);
    const double first = across(sites.front(), axis), last = across(sites.back(), axis);
    const double among = across(sites[sites.size() / 3], axis);
    for (const double m : {last, first, last + (last - first) / 7, first - (last - first) * 3, among}) {
      if (!std::isfinite(m))
        continue;
      const SplitLine line{m, axis};
      ASSERT_EQ(own_hull(sites, 77, line), split_path(numbered(sites), line)) << name << " at " << m;
    }
  }
}

TEST(OwnHull, is_the_path_of_every_distribution) {
  for (const Distribution distribution : all_distributions)
    for (const GlobalIndex n : {1, 50, 700, 30'000}) {
      std::vector<Point> sites(static_cast<std::size_t>(n));
      generate_points({distribution, n, 5}, 0, sites);
      expect_plain_hulls(sites, std::string(distribution_name(distribution)));
    }
}

TEST(OwnHull, is_the_path_of_what_is_unusual) {
  Random random(11);
  const auto many = [](const std::function<Point(int)> &site) {
    std::vector<Point> sites(3000);
    for (int i = 0; i < 3000; ++i)
      sites[static_cast<std::size_t>(i)] = site(i);
    return sites;
  };
  expect_plain_hulls(many([&](int) { return Point{0.25, random.uniform()}; }), "all x equal");
  expect_plain_hulls(many([&](int) { return Point{random.uniform(), 0.25}; }), "all y equal");
  expect_plain_hulls(many([&](int i) { return Point{double(i), 3.0 * i}; }), "oblique line");
  expect_plain_hulls(many([&](int i) {
                       return i % 2 == 0 ? Point{double(i), 0} : Point{0, double(i - 1500)};
                     }),
                     "cross");
  expect_plain_hulls(many([&](int i) {
                       return i == 0 ? Point{1e12, -1e12} : Point{random.uniform(), random.uniform()};
                     }),
                     "one far away");
  expect_plain_hulls(many([&](int) {
                       return Point{random.any_magnitude(), random.any_magnitude()};
                     }),
                     "every magnitude");
  expect_plain_hulls(many([&](int) { return Point{random.any_magnitude(), random.uniform()}; }), "wide");
  expect_plain_hulls(many([&](int) { return Point{random.uniform(), random.any_magnitude()}; }), "high");
  constexpr double largest = std::numeric_limits<double>::max(),
                   least = std::numeric_limits<double>::denorm_min();
  expect_plain_hulls(many([&](int) {
                       return Point{largest * random.integer(-1, 1), largest * random.uniform()};
                     }),
                     "as large as can be");
  expect_plain_hulls(many([&](int) {
                       return Point{least * random.integer(-60, 60), least * random.integer(-60, 60)};
                     }),
                     "as small as can be");
  for (const double scale : {0x1p-540, 0x1p-500, 0x1p+500, 0x1p+1000})
    expect_plain_hulls(many([&](int) {
                         return Point{scale * random.uniform(), scale * random.uniform()};
                       }),
                       "scaled");
}

/// Inside or on the circle of its pair, or beyond the ends.
bool can_be_on_path(const oracle::Site<mpz_class> &p, std::span<const oracle::Site<mpz_class>> approximate,
                    const mpz_class &m) {
  if (approximate.size() < 2 || p.y < approximate.front().y || p.y > approximate.back().y)
    return true;
  for (std::size_t i = 0; i + 1 < approximate.size(); ++i) {
    const auto &a = approximate[i], &b = approximate[i + 1];
    if (a.y <= p.y && p.y <= b.y && oracle::hull_polynomial(a, p, b, m) >= 0)
      return true;
  }
  return false;
}

/// How many sites were rejected, and how many could have been.
struct Rejections {
  int made = 0;
  int possible = 0;
};

void check_filter(const std::vector<Point> &some, const std::vector<Point> &others, double m,
                  Rejections &count) {
  const Path approximate = split_path(numbered(some), {m, Axis::x});
  const PathFilter filter(approximate, {m, Axis::x});
  std::vector<double> values = {m};
  for (const PathSite &site : approximate)
    values.insert(values.end(), {site.point.x, site.point.y});
  for (const Point p : others)
    values.insert(values.end(), {p.x, p.y});
  const std::vector<mpz_class> z = oracle::as_integers(values);
  std::vector<oracle::Site<mpz_class>> all;
  for (std::size_t i = 1; i < z.size(); i += 2)
    all.push_back({z[i], z[i + 1]});
  const auto path = std::span(all).first(approximate.size());
  for (std::size_t i = 0; i < others.size(); ++i) {
    const auto &site = all[approximate.size() + i];
    const bool passes = filter.lets_through(others[i]);
    const bool needed = can_be_on_path(site, path, z[0]);
    ASSERT_TRUE(passes || !needed) << others[i].x << " " << others[i].y << " line " << m;
    const bool outside_ends = site.y < path.front().y || site.y > path.back().y;
    const double distance = std::fabs(others[i].x - m);
    ASSERT_TRUE(!passes || outside_ends || !(distance > filter.reach()));
    const PathFilter::Interval quiet = filter.quiet_interval(distance);
    ASSERT_FALSE(passes && others[i].y > quiet.low && others[i].y < quiet.high);
    count.made += !passes;
    count.possible += !needed;
  }
}

TEST(PathFilter, never_rejects_what_can_be_on_a_path) {
  Random random(3);
  Rejections ordinary, extreme;
  const auto points = [&](int count, const std::function<Point()> &next) {
    std::vector<Point> result(static_cast<std::size_t>(count));
    std::ranges::generate(result, next);
    return result;
  };
  for (int round = 0; round < 1500 && !HasFatalFailure(); ++round) {
    const auto near_one = [&] { return Point{random.uniform(), random.uniform()}; };
    const auto anywhere = [&] { return Point{random.any_magnitude(), random.any_magnitude()}; };
    const int exponent = random.integer(-1074, 1018);
    const auto of_one_magnitude = [&] { // few bits: many sites exactly on circles
      return Point{std::ldexp(random.integer(0, 15), exponent), std::ldexp(random.integer(0, 15), exponent)};
    };
    check_filter(points(20, near_one), points(60, near_one), random.uniform(), ordinary);
    check_filter(points(15, anywhere), points(40, anywhere), random.any_magnitude(), extreme);
    check_filter(points(8, of_one_magnitude), points(60, of_one_magnitude),
                 std::ldexp(random.integer(0, 15), exponent), extreme);
  }
  EXPECT_EQ(ordinary.made, ordinary.possible) << "only the last few bits may make a difference";
  EXPECT_GT(ordinary.possible, 40'000);
  EXPECT_GT(extreme.made, extreme.possible / 4) << "of " << extreme.possible;
}

} // namespace
} // namespace dovetail
