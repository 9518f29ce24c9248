// The synthetic point sets: the right bits, the right distributions, the same whatever the block.
#include "dovetail/geometry/distributions.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

namespace dovetail {
namespace {

std::vector<Point> points_of(const SyntheticSet &set, GlobalIndex first, GlobalIndex count) {
  std::vector<Point> points(static_cast<std::size_t>(count));
  generate_points(set, first, points);
  return points;
}
std::vector<Point> all_points(Distribution distribution, GlobalIndex n, std::uint64_t seed = 1) {
  return points_of({distribution, n, seed}, 0, n);
}

// Units in the last place between two doubles of the same sign.
std::int64_t ulps_between(double a, double b) {
  return std::abs(std::bit_cast<std::int64_t>(a) - std::bit_cast<std::int64_t>(b));
}

double mean(const std::vector<double> &values) {
  double sum = 0;
  for (const double v : values)
    sum += v;
  return sum / static_cast<double>(values.size());
}
double variance(const std::vector<double> &values) {
  std::vector<double> squares;
  const double m = mean(values);
  for (const double v : values)
    squares.push_back((v - m) * (v - m));
  return mean(squares);
}
// Largest distance between the empirical distribution and the given one, times sqrt(n) (Kolmogorov and
// Smirnov): above 1.95 once in a thousand honest samples.
template <class Cumulative> double kolmogorov(std::vector<double> values, Cumulative cumulative) {
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size());
  double worst = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double c = cumulative(values[i]);
    worst = std::max({worst, c - static_cast<double>(i) / n, static_cast<double>(i + 1) / n - c});
  }
  return worst * std::sqrt(n);
}
template <class Value> std::vector<double> each(const std::vector<Point> &points, Value value) {
  std::vector<double> values;
  for (const Point p : points)
    values.push_back(value(p));
  return values;
}
double x_of(Point p) { return p.x; }
double y_of(Point p) { return p.y; }
double radius_of(Point p) { return std::hypot(p.x, p.y); }
double turns_of(Point p) { return std::atan2(p.y, p.x) / 6.283185307179586 + 0.5; }
double normal_cumulative(double v) { return 0.5 * std::erfc(-v / std::sqrt(2.0)); }
double uniform_cumulative(double v) { return std::clamp(v, 0.0, 1.0); }

// Worked out independently by distributions_reference.py.
struct KnownPoint {
  Distribution distribution;
  GlobalIndex n;
  std::uint64_t seed;
  GlobalIndex index;
  std::uint64_t x, y;
};
const KnownPoint known_points[] = {
    // clang-format off
    {Distribution::uniform, 1000, 0x0, 0, 0x3fc0983a45556400, 0x3fa98f1f72f39ca0},
    {Distribution::uniform, 1000, 0x1, 1, 0x3fe23be562ca4005, 0x3fd072f36548f22c},
    {Distribution::uniform, 1000, 0x1, 999, 0x3fd6e75f651d2260, 0x3fe6c3f12512601c},
    {Distribution::uniform, 1000000000000, 0xffffffffffffffff, 999999999999, 0x3fe0dcab8c559ee3, 0x3fe899816d645bc1},
    {Distribution::normal, 1000, 0x0, 0, 0x3ff1788afbb5532f, 0x3ff38b4d271deda2},
    {Distribution::normal, 1000, 0x1, 1, 0x3fdd304b0018d800, 0xbff965f6086f1767},
    {Distribution::normal, 1000, 0x1, 999, 0xbfed5222d724572b, 0x3ff5cec53f81af07},
    {Distribution::normal, 1000000000000, 0xffffffffffffffff, 999999999999, 0x3fc40987d9dd40bf, 0x3ff8fcd1222ea040},
    {Distribution::kuzmin, 1000, 0x0, 0, 0xbfe0eed0171356c9, 0x3fc9a1def446ec1b},
    {Distribution::kuzmin, 1000, 0x1, 1, 0xbff1ee21c81e4e2c, 0xbffc631895c20aa4},
    {Distribution::kuzmin, 1000, 0x1, 999, 0x3ff0de76645408fb, 0xbfe1ec143c05db0d},
    {Distribution::kuzmin, 1000000000000, 0xffffffffffffffff, 999999999999, 0x3ffb14213583c9db, 0xbfe8dfe215f081ce},
    {Distribution::line, 1000, 0x0, 0, 0x3f7f6214f07a84c8, 0x3fa98f1f72f39ca0},
    {Distribution::line, 1000, 0x1, 1, 0x3f5cbb4f171e6a31, 0x3fd072f36548f22c},
    {Distribution::line, 1000, 0x1, 999, 0x3f66d9916bbee245, 0x3fe6c3f12512601c},
    {Distribution::line, 1000000000000, 0xffffffffffffffff, 999999999999, 0x3f5f10a3988cb9d7, 0x3fe899816d645bc1},
    {Distribution::lattice, 1000, 0x0, 0, 0x402e000000000000, 0x403d000000000000},
    {Distribution::lattice, 1000, 0x1, 1, 0x403f000000000000, 0x3ff0000000000000},
    {Distribution::lattice, 1000, 0x1, 999, 0x403b000000000000, 0x4020000000000000},
    {Distribution::lattice, 1000000000000, 0xffffffffffffffff, 999999999999, 0x41298a4400000000, 0x412dccaa00000000},
    {Distribution::circle, 1000, 0x0, 0, 0x3fe5539b49040844, 0x3fe7db8013e7de18},
    {Distribution::circle, 1000, 0x1, 1, 0x3fd1ac3ee3e284cd, 0xbfeec17a817a7d36},
    {Distribution::circle, 1000, 0x1, 999, 0xbfe1da644d6e01ea, 0x3fea8e8eb1d5a2a4},
    {Distribution::circle, 1000000000000, 0xffffffffffffffff, 999999999999, 0x3fb9884ffe9f149d, 0x3fefd7276b1bcabb},
    {Distribution::lidar, 1000, 0x0, 0, 0x406034cccccccccd, 0x4048f5c28f5c28f6},
    {Distribution::lidar, 1000, 0x1, 1, 0x4081ce7ae147ae14, 0x40701051eb851eb8},
    {Distribution::lidar, 1000, 0x1, 999, 0x40765deb851eb852, 0x40863b5c28f5c28f},
    {Distribution::lidar, 1000000000000, 0xffffffffffffffff, 999999999999, 0x408077851eb851ec, 0x408805eb851eb852},
    {Distribution::clusters, 1000, 0x0, 0, 0x3fd5f54da16d4230, 0x3fe7579a13313b53},
    {Distribution::clusters, 1000, 0x1, 1, 0x3fd3edf159265f6f, 0x3fe69a4aa7d09639},
    {Distribution::clusters, 1000, 0x1, 999, 0x3fe2dd7ca2b111cd, 0x3fb1fb95eaa94c2a},
    {Distribution::clusters, 1000000000000, 0xffffffffffffffff, 999999999999, 0x3febcb3560fa5682, 0x3fc3d41a1514b660},
    // clang-format on
};

TEST(Distributions, KnownBits) {
  for (const KnownPoint &known : known_points) {
    const Point p = points_of({known.distribution, known.n, known.seed}, known.index, 1).front();
    // The reference's logarithm is correctly rounded; ours is good to two units, which the square root
    // and the products pass on.
    const bool logarithmic =
        known.distribution == Distribution::normal || known.distribution == Distribution::clusters;
    const std::int64_t allowed = logarithmic ? 3 : 0;
    EXPECT_LE(ulps_between(p.x, std::bit_cast<double>(known.x)), allowed)
        << distribution_name(known.distribution) << " " << known.index;
    EXPECT_LE(ulps_between(p.y, std::bit_cast<double>(known.y)), allowed)
        << distribution_name(known.distribution) << " " << known.index;
  }
}

TEST(Distributions, MixIsSplitmix64) {
  // The first words of the published splitmix64.c seeded with 1234567.
  std::uint64_t state = 1234567;
  const std::uint64_t published[] = {6457827717110365317u, 3203168211198807973u, 9817491932198370423u,
                                     4593380528125082431u, 16408922859458223821u};
  for (const std::uint64_t word : published)
    EXPECT_EQ(synthetic::mix(state += synthetic::golden_gamma), word);
}

TEST(Distributions, Names) {
  for (const Distribution d : all_distributions)
    EXPECT_EQ(distribution_named(distribution_name(d)), d);
  EXPECT_EQ(distribution_name(Distribution::clusters), "clusters");
  EXPECT_EQ(distribution_name(Distribution::kuzmin), "kuzmin");
  EXPECT_FALSE(distribution_named("Uniform"));
  EXPECT_FALSE(distribution_named(""));
}

TEST(Distributions, SameBitsForBlocksOfEverySize) {
  constexpr GlobalIndex n = 1009;
  for (const Distribution d : all_distributions) {
    const SyntheticSet set{d, n, 42};
    const std::vector<Point> whole = points_of(set, 0, n);
    std::vector<double> heights(n);
    if (has_height(d))
      generate_heights(set, 0, heights);
    for (const GlobalIndex block : {1, 2, 3, 7, 64, 100, 1008, 1009})
      for (GlobalIndex first = 0; first < n; first += block) {
        const GlobalIndex count = std::min(block, n - first);
        const auto from = static_cast<std::size_t>(first);
        const std::vector<Point> part = points_of(set, first, count);
        EXPECT_TRUE(std::equal(part.begin(), part.end(), whole.begin() + first)) << distribution_name(d);
        if (has_height(d)) {
          std::vector<double> z(static_cast<std::size_t>(count));
          generate_heights(set, first, z);
          EXPECT_TRUE(std::equal(z.begin(), z.end(), heights.begin() + static_cast<std::ptrdiff_t>(from)));
        }
      }
  }
}

TEST(Distributions, SeedsAndPointsDiffer) {
  for (const Distribution d : all_distributions) {
    const auto a = all_points(d, 500, 1), b = all_points(d, 500, 2);
    int equal = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
      equal += a[i] == b[i] ? 1 : 0;
    EXPECT_LE(equal, 5) << distribution_name(d);
  }
  std::set<std::pair<double, double>> distinct;
  for (const Point p : all_points(Distribution::uniform, 20000))
    distinct.insert({p.x, p.y});
  EXPECT_EQ(distinct.size(), 20000u);
}

TEST(Distributions, LogarithmAgainstLibm) {
  std::int64_t worst = 0;
  synthetic::Draws draws(7, 7);
  for (int i = 0; i < 1'000'000; ++i) {
    // Half of them over the whole range of exponents, half in (0, 1) as they are used, close to 1 too.
    double v = draws.unit();
    if (i % 4 == 0)
      v = std::ldexp(1 + v, static_cast<int>(draws.below(2046)) - 1022);
    else if (i % 4 == 1)
      v = 1 - v * 0x1p-20;
    if (v == 0 || v == 1)
      continue;
    worst = std::max(worst, ulps_between(synthetic::logarithm(v), std::log(v)));
  }
  EXPECT_LE(worst, 2);
  EXPECT_EQ(synthetic::logarithm(1), 0);
}

TEST(Distributions, CeilSqrt) {
  EXPECT_EQ(synthetic::ceil_sqrt(0), 0u);
  for (std::uint64_t n = 1; n < 5000; ++n) {
    const std::uint64_t c = synthetic::ceil_sqrt(n);
    EXPECT_TRUE(c * c >= n && (c - 1) * (c - 1) < n) << n;
  }
  for (const std::uint64_t root : {94906265u, 94906267u, 2147483647u, 2000000001u}) {
    EXPECT_EQ(synthetic::ceil_sqrt(root * root), root);
    EXPECT_EQ(synthetic::ceil_sqrt(root * root + 1), root + 1);
    EXPECT_EQ(synthetic::ceil_sqrt(root * root - 1), root);
  }
}

TEST(Distributions, Uniform) {
  const auto points = all_points(Distribution::uniform, 100'000);
  EXPECT_LT(kolmogorov(each(points, x_of), uniform_cumulative), 1.95);
  EXPECT_LT(kolmogorov(each(points, y_of), uniform_cumulative), 1.95);
  // x and y independent: chi-square of a 16 x 16 grid, 255 degrees of freedom, five sigma.
  std::vector<double> count(256, 0);
  for (const Point p : points)
    count[static_cast<std::size_t>(p.x * 16) * 16 + static_cast<std::size_t>(p.y * 16)] += 1;
  double chi_square = 0;
  const double expected = 100'000.0 / 256;
  for (const double c : count)
    chi_square += (c - expected) * (c - expected) / expected;
  EXPECT_NEAR(chi_square, 255, 5 * std::sqrt(2 * 255.0));
}

TEST(Distributions, Normal) {
  const auto points = all_points(Distribution::normal, 100'000);
  EXPECT_LT(kolmogorov(each(points, x_of), normal_cumulative), 1.95);
  EXPECT_LT(kolmogorov(each(points, y_of), normal_cumulative), 1.95);
  EXPECT_NEAR(mean(each(points, [](Point p) { return p.x * p.y; })), 0, 5 / std::sqrt(100'000.0));
  // r^2 / 2 is exponential exactly if both are normal and independent.
  EXPECT_LT(kolmogorov(each(points, radius_of), [](double r) { return 1 - std::exp(-r * r / 2); }), 1.95);
}

TEST(Distributions, KuzminRadiusAndDirection) {
  const auto points = all_points(Distribution::kuzmin, 100'000);
  const auto cumulative = [](double r) { return 1 - 1 / std::sqrt(1 + r * r); };
  EXPECT_LT(kolmogorov(each(points, radius_of), cumulative), 1.95);
  EXPECT_LT(kolmogorov(each(points, turns_of), uniform_cumulative), 1.95);
  auto radii = each(points, radius_of);
  std::sort(radii.begin(), radii.end());
  // 1 - 1 / sqrt(1 + 3) = 1/2; five sigma of the order statistic: 5 * 0.5 / sqrt(n) / density(sqrt 3).
  EXPECT_NEAR(radii[50'000], std::sqrt(3.0), 5 * 0.5 / std::sqrt(100'000.0) / (std::sqrt(3.0) / 8));
  EXPECT_TRUE(std::isfinite(radii.back()));
}

TEST(Distributions, Line) {
  const auto points = all_points(Distribution::line, 100'000);
  // x = b / (u (1 - b) + b) solved for u, and large x for small u.
  const auto cumulative = [](double x) { return 1 - (0.001 / x - 0.001) / 0.999; };
  EXPECT_LT(kolmogorov(each(points, x_of), cumulative), 1.95);
  EXPECT_LT(kolmogorov(each(points, y_of), uniform_cumulative), 1.95);
  for (const Point p : points)
    EXPECT_TRUE(p.x >= 0.0009999 && p.x <= 1);
}

TEST(Distributions, LatticeIsAPermutationOfTheExactSet) {
  for (const GlobalIndex n : {1, 2, 3, 4, 5, 7, 8, 9, 10, 15, 16, 17, 99, 100, 101, 9999, 90'000, 90'001}) {
    const auto columns = static_cast<GlobalIndex>(std::ceil(std::sqrt(static_cast<double>(n))));
    std::set<std::pair<double, double>> made, wanted;
    for (const Point p : all_points(Distribution::lattice, n))
      made.insert({p.x, p.y});
    for (GlobalIndex i = 0; i < n; ++i) {
      const GlobalIndex column = i % columns, row = i / columns;
      wanted.insert({static_cast<double>(column), static_cast<double>(row)});
    }
    EXPECT_EQ(made, wanted) << n;
  }
}

TEST(Distributions, LatticeIsShuffled) {
  constexpr GlobalIndex n = 90'000;
  const auto points = all_points(Distribution::lattice, n);
  // The place in reading order of point i is uniform in every block of points.
  for (const std::ptrdiff_t first : {0, 10'000, 80'000}) {
    const std::vector<Point> block(points.begin() + first, points.begin() + first + 10'000);
    EXPECT_LT(
        kolmogorov(each(block, [](Point p) { return (p.y * 300 + p.x + 0.5) / n; }), uniform_cumulative),
        1.95);
    EXPECT_LT(
        kolmogorov(each(block, [](Point p) { return (p.x * 300 + p.y + 0.5) / n; }), uniform_cumulative),
        1.95);
  }
  int neighbours = 0; // consecutive points that are neighbours on the lattice
  for (std::size_t i = 1; i < points.size(); ++i)
    neighbours +=
        std::abs(points[i].x - points[i - 1].x) + std::abs(points[i].y - points[i - 1].y) <= 1 ? 1 : 0;
  EXPECT_LT(neighbours, 30); // about 4 expected
}

TEST(Distributions, Circle) {
  const auto points = all_points(Distribution::circle, 100'000);
  EXPECT_LT(kolmogorov(each(points, turns_of), uniform_cumulative), 1.95);
  for (const Point p : points)
    EXPECT_NEAR(p.x * p.x + p.y * p.y, 1, 1e-15);
}

TEST(Distributions, Lidar) {
  constexpr GlobalIndex n = 1'000'000;
  const SyntheticSet set{Distribution::lidar, n, 3};
  auto points = points_of(set, 0, n);
  std::vector<double> z(n);
  generate_heights(set, 0, z);
  EXPECT_LT(kolmogorov(each(points, [](Point p) { return p.x / 1000; }), uniform_cumulative), 1.95);
  const auto is_nearest_decimal = [](double v) { return v == std::round(v * 100) / 100; };
  std::set<double> different_z(z.begin(), z.begin() + 1000);
  EXPECT_GT(different_z.size(), 900u);
  for (std::size_t i = 0; i < points.size(); i += 10) {
    EXPECT_TRUE(is_nearest_decimal(points[i].x) && is_nearest_decimal(points[i].y) &&
                is_nearest_decimal(z[i]));
    EXPECT_TRUE(points[i].x >= 0 && points[i].x <= 1000 && points[i].y >= 0 && points[i].y <= 1000);
    EXPECT_TRUE(z[i] > 100 && z[i] < 300);
  }
  // The ground is smooth: neighbours within a metre differ little unless one is in a tree.
  std::vector<std::pair<Point, double>> by_place;
  for (std::size_t i = 0; i < points.size(); ++i)
    by_place.push_back({points[i], z[i]});
  std::sort(by_place.begin(), by_place.end(),
            [](const auto &a, const auto &b) { return lexicographically_less(a.first, b.first); });
  int near = 0, smooth = 0, steep = 0;
  for (std::size_t i = 1; i < by_place.size(); ++i) {
    const Point a = by_place[i - 1].first, b = by_place[i].first;
    if (std::hypot(a.x - b.x, a.y - b.y) < 0.3) {
      const double rise = std::abs(by_place[i - 1].second - by_place[i].second);
      near += 1;
      smooth += rise < 0.5 ? 1 : 0;
      steep += rise > 4 ? 1 : 0;
    }
  }
  EXPECT_GT(near, 200);
  EXPECT_GT(smooth, near / 2);
  EXPECT_GT(steep, 0); // canopy above ground at the same place
  // n^2 / 2 / 10^10 = 50 pairs expected at the same place.
  std::sort(points.begin(), points.end(), lexicographically_less);
  int pairs = 0;
  for (std::size_t i = 1; i < points.size(); ++i)
    pairs += points[i] == points[i - 1] ? 1 : 0;
  EXPECT_NEAR(pairs, 50, 5 * std::sqrt(50.0));
}

TEST(Distributions, Clusters) {
  constexpr GlobalIndex n = 40'000; // 200 clusters
  const auto points = all_points(Distribution::clusters, n);
  // The centres are known from their own stream: every point is near one, and its offset is normal.
  std::vector<Point> centres;
  for (std::uint64_t c = 0; c < 200; ++c) {
    synthetic::Draws draws(synthetic::stream_key(1, 1), c);
    const double x = draws.unit();
    centres.push_back({x, draws.unit()});
  }
  std::vector<double> count(200, 0), dx;
  for (const Point p : points) {
    const auto distance = [p](Point c) { return std::hypot(p.x - c.x, p.y - c.y); };
    const auto nearest = std::min_element(centres.begin(), centres.end(),
                                          [&](Point a, Point b) { return distance(a) < distance(b); });
    EXPECT_LT(distance(*nearest), 0.006);
    count[static_cast<std::size_t>(nearest - centres.begin())] += 1;
    dx.push_back((p.x - nearest->x) * 1000);
  }
  EXPECT_NEAR(mean(dx), 0, 0.03);
  EXPECT_NEAR(variance(dx), 1, 0.05); // a little less: overlapping clusters steal
  EXPECT_GT(*std::min_element(count.begin(), count.end()), 100);
  EXPECT_LT(*std::max_element(count.begin(), count.end()), 320);
}

TEST(Distributions, OneAndNoPoint) {
  for (const Distribution d : all_distributions) {
    EXPECT_TRUE(all_points(d, 0).empty());
    const Point p = all_points(d, 1).front();
    EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y)) << distribution_name(d);
  }
}

} // namespace
} // namespace dovetail
