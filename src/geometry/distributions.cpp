#include "dovetail/geometry/distributions.hpp"

#include <array>
#include <bit>
#include <cassert>
#include <cfloat>
#include <cmath>
#include <cstddef>

// Excess precision (x87) would give other bits.
static_assert(FLT_EVAL_METHOD == 0, "distributions must be the same on every CPU: compile with -msse2");

namespace dovetail {
namespace {

using synthetic::absorb;
using synthetic::Draws;
using synthetic::stream_key;

// Streams of one seed. Changing a number changes the sets.
enum Stream : std::uint64_t { stream_points, stream_centres, stream_shuffle, stream_ground, stream_trees };

constexpr std::array<std::string_view, 8> names = {"uniform", "normal", "kuzmin", "line",
                                                   "lattice", "circle", "lidar",  "clusters"};

struct Direction {
  double x, y;
  double squared; // x^2 + y^2, in (0, 1)
};

// The whole part of a number that is not negative.
double whole(double value) { return static_cast<double>(static_cast<std::int64_t>(value)); }

// Uniform in the open unit disk without its centre, by rejection from the square (on average 1.27 tries).
Direction in_disk(Draws &draws) {
  for (;;) {
    const double x = 2 * draws.unit() - 1, y = 2 * draws.unit() - 1;
    const double squared = x * x + y * y;
    if (squared > 0 && squared < 1)
      return {x, y, squared};
  }
}

Point uniform_point(Draws &draws) {
  const double x = draws.unit();
  return {x, draws.unit()};
}

// Marsaglia's polar method.
Point normal_point(Draws &draws) {
  const Direction d = in_disk(draws);
  const double factor = std::sqrt(-2 * synthetic::logarithm(d.squared) / d.squared);
  return {d.x * factor, d.y * factor};
}

// u = 1 - 1 / sqrt(1 + r^2) solved for r; 1 - u is exact and at least 2^-53.
Point kuzmin_point(Draws &draws) {
  const double u = draws.unit();
  const double radius = std::sqrt(u * (2 - u)) / (1 - u);
  const Direction d = in_disk(draws);
  const double factor = radius / std::sqrt(d.squared);
  return {d.x * factor, d.y * factor};
}

Point line_point(Draws &draws) {
  constexpr double b = 0.001;
  const double u = draws.unit();
  const double x = b / (u - b * u + b);
  return {x, draws.unit()};
}

Point circle_point(Draws &draws) {
  const Direction d = in_disk(draws);
  const double length = std::sqrt(d.squared);
  return {d.x / length, d.y / length};
}

Point lidar_point(Draws &draws) {
  // Whole hundredths divided by 100 are the doubles nearest to the decimals.
  const auto rounded = [&] { return whole(draws.unit() * 100000 + 0.5) / 100; };
  const double x = rounded();
  return {x, rounded()};
}

Point cluster_point(Draws &draws, std::uint64_t centres_key, std::uint64_t clusters) {
  Draws centre_draws(centres_key, draws.below(clusters));
  const Point centre = uniform_point(centre_draws);
  const Point offset = normal_point(draws);
  return {centre.x + 0.001 * offset.x, centre.y + 0.001 * offset.y};
}

// A random bijection of 0 .. n - 1: a Feistel network on (column, row) with additions modulo their numbers,
// walked on from the few places of the last row that do not exist.
class LatticeOrder {
public:
  LatticeOrder(std::uint64_t n, std::uint64_t seed) : n_(n), columns_(synthetic::ceil_sqrt(n)) {
    rows_ = columns_ == 0 ? 0 : (n + columns_ - 1) / columns_;
    for (std::size_t round = 0; round < keys_.size(); ++round)
      keys_[round] = absorb(stream_key(seed, stream_shuffle), round);
  }

  Point place(std::uint64_t index) const {
    std::uint64_t column = index % columns_, row = index / columns_;
    do {
      for (std::size_t round = 0; round < keys_.size(); round += 2) {
        column = (column + below(absorb(keys_[round], row), columns_)) % columns_;
        row = (row + below(absorb(keys_[round + 1], column), rows_)) % rows_;
      }
    } while (row * columns_ + column >= n_);
    return {static_cast<double>(column), static_cast<double>(row)};
  }

private:
  static std::uint64_t below(std::uint64_t word, std::uint64_t bound) { return ((word >> 32) * bound) >> 32; }

  std::uint64_t n_, columns_, rows_;
  std::array<std::uint64_t, 6> keys_;
};

// Smooth noise in [-1, 1]: hashed values on a grid, blended so that two derivatives are continuous (Perlin
// 2002).
double value_noise(std::uint64_t key, double x, double y) {
  const double column = whole(x), row = whole(y);
  const auto fade = [](double t) { return t * t * t * (t * (t * 6 - 15) + 10); };
  const double s = fade(x - column), t = fade(y - row);
  const auto at = [&](double i, double j) {
    const auto word = absorb(key, (static_cast<std::uint64_t>(i) << 32) + static_cast<std::uint64_t>(j));
    return static_cast<double>(word >> 11) * 0x1p-52 - 1;
  };
  const double low = at(column, row) + s * (at(column + 1, row) - at(column, row));
  const double high = at(column, row + 1) + s * (at(column + 1, row + 1) - at(column, row + 1));
  return low + t * (high - low);
}

struct Landscape {
  explicit Landscape(std::uint64_t seed)
      : ground_key(stream_key(seed, stream_ground)), trees_key(stream_key(seed, stream_trees)) {}

  double ground(Point p) const {
    return 200 + 40 * value_noise(absorb(ground_key, 0), p.x / 256, p.y / 256) +
           8 * value_noise(absorb(ground_key, 1), p.x / 64, p.y / 64) +
           value_noise(absorb(ground_key, 2), p.x / 16, p.y / 16);
  }

  // Height of the crown above the ground; 0 beside trees. Every second square of 8 m has a tree inside.
  double crown(Point p) const {
    const double column = whole(p.x / 8), row = whole(p.y / 8);
    Draws tree(trees_key, (static_cast<std::uint64_t>(column) << 32) + static_cast<std::uint64_t>(row));
    if (tree.unit() < 0.5)
      return 0;
    const double radius = 1 + 2 * tree.unit(), height = 5 + 20 * tree.unit();
    const double dx = p.x - (8 * column + 3 + 2 * tree.unit());
    const double dy = p.y - (8 * row + 3 + 2 * tree.unit());
    const double relative = (dx * dx + dy * dy) / (radius * radius);
    return relative < 1 ? height * (1 - 0.6 * relative) : 0;
  }

  std::uint64_t ground_key, trees_key;
};

template <class Element, class Make>
void fill(GlobalIndex first, std::uint64_t key, std::span<Element> elements, Make make) {
  for (std::size_t i = 0; i < elements.size(); ++i) {
    Draws draws(key, static_cast<std::uint64_t>(first) + i);
    elements[i] = make(draws);
  }
}

} // namespace

std::string_view distribution_name(Distribution distribution) {
  return names[static_cast<std::size_t>(distribution)];
}

std::optional<Distribution> distribution_named(std::string_view name) {
  for (const Distribution distribution : all_distributions)
    if (distribution_name(distribution) == name)
      return distribution;
  return std::nullopt;
}

void generate_points(const SyntheticSet &set, GlobalIndex first, std::span<Point> points) {
  assert(first >= 0 && first + static_cast<GlobalIndex>(points.size()) <= set.n);
  const std::uint64_t key = stream_key(set.seed, stream_points);
  switch (set.distribution) {
  case Distribution::uniform:
    return fill(first, key, points, uniform_point);
  case Distribution::normal:
    return fill(first, key, points, normal_point);
  case Distribution::kuzmin:
    return fill(first, key, points, kuzmin_point);
  case Distribution::line:
    return fill(first, key, points, line_point);
  case Distribution::circle:
    return fill(first, key, points, circle_point);
  case Distribution::lidar:
    return fill(first, key, points, lidar_point);
  case Distribution::lattice: {
    const LatticeOrder order(static_cast<std::uint64_t>(set.n), set.seed);
    for (std::size_t i = 0; i < points.size(); ++i)
      points[i] = order.place(static_cast<std::uint64_t>(first) + i);
    return;
  }
  case Distribution::clusters: {
    const auto n = static_cast<std::uint64_t>(set.n);
    const std::uint64_t rounded_up = synthetic::ceil_sqrt(n);
    const std::uint64_t clusters = rounded_up * rounded_up > n ? rounded_up - 1 : rounded_up;
    const std::uint64_t centres_key = stream_key(set.seed, stream_centres);
    return fill(first, key, points,
                [=](Draws &draws) { return cluster_point(draws, centres_key, clusters); });
  }
  }
}

void generate_heights(const SyntheticSet &set, GlobalIndex first, std::span<double> heights) {
  assert(has_height(set.distribution));
  const Landscape land(set.seed);
  fill(first, stream_key(set.seed, stream_points), heights, [&](Draws &draws) {
    const Point p = lidar_point(draws);
    // Three pulses of four are stopped by a crown.
    const double above = draws.unit() < 0.75 ? land.crown(p) : 0;
    return whole((land.ground(p) + above) * 100 + 0.5) / 100;
  });
}

namespace synthetic {

double logarithm(double value) {
  // value = 2^exponent * m with m in [sqrt(1/2), sqrt(2)); log m = 2 artanh(f), f = (m - 1) / (m + 1).
  constexpr std::uint64_t sqrt_half_bits = 0x3fe6a09e667f3bcd;
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const auto exponent = static_cast<std::int64_t>(bits - sqrt_half_bits) >> 52;
  const double m = std::bit_cast<double>(bits - (static_cast<std::uint64_t>(exponent) << 52));
  const double above_one = m - 1; // exact
  const double f = above_one / (2 + above_one);
  const double w = f * f; // at most 0.0295: twelve terms reach the last place
  constexpr std::array<double, 11> terms = {2.0 / 23, 2.0 / 21, 2.0 / 19, 2.0 / 17, 2.0 / 15, 2.0 / 13,
                                            2.0 / 11, 2.0 / 9,  2.0 / 7,  2.0 / 5,  2.0 / 3};
  double tail = 2.0 / 25;
  for (const double term : terms)
    tail = tail * w + term;
  // 2 f = above_one - f * above_one: the leading term is exact and what is rounded is small against it.
  const double small = f * (w * tail - above_one);
  constexpr double ln2_high = 0x1.62e42fee00000p-1; // a multiple of 2^-33, so exponent * ln2_high is exact
  constexpr double ln2_low = 0x1.a39ef35793c76p-33;
  const auto e = static_cast<double>(exponent);
  return e * ln2_high + (above_one + (small + e * ln2_low));
}

std::uint64_t ceil_sqrt(std::uint64_t n) {
  auto root = static_cast<std::uint64_t>(std::sqrt(static_cast<double>(n)));
  while (root * root < n)
    ++root;
  while (root > 0 && (root - 1) * (root - 1) >= n)
    --root;
  return root;
}

} // namespace synthetic
} // namespace dovetail
