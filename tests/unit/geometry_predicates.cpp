// Every predicate, filtered and exact, against GMP on more than a million cases of every kind of trouble.

#include "dovetail/geometry/predicates.hpp"
#include "support/rational_oracle.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <random>

namespace dovetail {
namespace {

struct Case {
  std::array<Point, 4> points;
  double line;
};

class Random {
public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}
  std::uint64_t bits() { return bits_(); }
  int integer(int low, int high) {
    return low + static_cast<int>(bits_() % static_cast<std::uint64_t>(high - low + 1));
  }
  double uniform() { return static_cast<double>(bits_() >> 11) * 0x1p-53; }
  bool coin() { return (bits_() & 1) != 0; }
  double with_sign(double value) { return coin() ? value : -value; }

private:
  std::mt19937_64 bits_;
};

double ulps_away(double value, int steps) {
  const double to = steps < 0 ? -std::numeric_limits<double>::max() : std::numeric_limits<double>::max();
  for (int i = 0; i < std::abs(steps); ++i)
    value = std::nextafter(value, to);
  return value;
}

/// The line is somewhere, or exactly through a point, or an ulp beside it.
double line_near(Random &random, const std::array<Point, 4> &points) {
  const Point p = points[random.bits() % 4];
  const double coordinate = random.coin() ? p.x : p.y;
  switch (random.integer(0, 3)) {
  case 0:
    return coordinate;
  case 1:
    return ulps_away(coordinate, random.integer(-1, 1));
  case 2:
    return coordinate / 2 + points[random.bits() % 4].x / 2;
  default:
    return std::min(std::max(coordinate * (2 * random.uniform()), -1e308), 1e308);
  }
}

Case from_each(Random &random, const std::function<Point()> &next) {
  Case result;
  for (Point &p : result.points)
    p = next();
  result.line = line_near(random, result.points);
  return result;
}

Case uniform_case(Random &random) {
  return from_each(random, [&] { return Point{random.uniform(), random.uniform()}; });
}

Case decimal_case(Random &random) {
  const double x = random.integer(0, 700000), y = random.integer(4000000, 5000000);
  return from_each(random, [&] {
    return Point{x + random.integer(0, 30) / 100.0, y + random.integer(0, 30) / 100.0};
  });
}

Case neighbouring_case(Random &random) {
  const Point p{random.with_sign(random.uniform()), random.with_sign(random.uniform())};
  const int steps = random.coin() ? 1 : 5;
  return from_each(random, [&] {
    return Point{ulps_away(p.x, random.integer(-steps, steps)),
                 ulps_away(p.y, random.integer(-steps, steps))};
  });
}

Case lattice_case(Random &random) {
  const int size = random.coin() ? 3 : 8;
  const double scale =
      random.coin() ? 1.0 : std::ldexp(1 + 2 * random.integer(0, 1000), random.integer(-900, 900));
  return from_each(random, [&] {
    return Point{scale * random.integer(0, size), scale * random.integer(-size, size)};
  });
}

/// Integer points on one circle, moved and scaled exactly, some of them then moved by an ulp.
Case cocircular_case(Random &random) {
  struct Integers {
    int x, y;
  };
  static constexpr std::array<Integers, 9> first_octant = {
      {{63, 16}, {60, 25}, {56, 33}, {52, 39}, {65, 0}, {63, 16}, {60, 25}, {56, 33}, {52, 39}}}; // radius 65
  const int dx = random.integer(-3000, 3000), dy = random.integer(-3000, 3000);
  const double scale = std::ldexp(1.0, random.integer(-400, 400));
  const bool exactly = random.coin();
  return from_each(random, [&] {
    Integers p = first_octant[random.bits() % 9];
    if (random.coin())
      std::swap(p.x, p.y);
    p.x = random.coin() ? p.x : -p.x;
    p.y = random.coin() ? p.y : -p.y;
    const int off = exactly ? 0 : random.integer(-1, 1);
    return Point{ulps_away(scale * (p.x + dx), off), scale * (p.y + dy)};
  });
}

Case collinear_case(Random &random) {
  const Point p{random.uniform(), random.uniform()}, d{random.uniform() - 0.5, random.uniform() - 0.5};
  return from_each(random, [&] {
    const double t = random.coin() ? random.integer(-4, 4) : random.uniform();
    return Point{ulps_away(p.x + t * d.x, random.integer(-1, 1)), p.y + t * d.y};
  });
}

Case rounded_circle_case(Random &random) {
  const double radius = std::ldexp(1.0, random.integer(-20, 20)),
               centre = random.coin() ? 0 : random.uniform();
  return from_each(random, [&] {
    const double angle = 6.283185307179586 * random.uniform();
    return Point{centre + radius * std::cos(angle), radius * std::sin(angle)};
  });
}

Case extreme_case(Random &random) {
  return from_each(random, [&] {
    const auto extreme = [&] {
      switch (random.integer(0, 7)) {
      case 0:
        return 0.0;
      case 1:
        return random.with_sign(std::numeric_limits<double>::denorm_min() * random.integer(1, 9));
      case 2:
        return random.with_sign(ulps_away(std::numeric_limits<double>::max(), -random.integer(0, 2)));
      case 3:
        return random.with_sign(std::numeric_limits<double>::min());
      default:
        return random.with_sign(random.uniform() * std::pow(10.0, random.integer(-300, 300)));
      }
    };
    return Point{extreme(), extreme()};
  });
}

/// All of one magnitude, anywhere: where products of the second, third or fourth degree over- or underflow.
Case scaled_case(Random &random) {
  const int exponent = random.integer(-1070, 1020);
  const int bits = random.coin() ? 4 : 53;
  return from_each(random, [&] {
    const auto coordinate = [&] {
      return random.with_sign(std::ldexp(static_cast<double>(random.bits() >> (64 - bits)), exponent - bits));
    };
    return Point{coordinate(), coordinate()};
  });
}

/// Two coordinates far apart in size inside every product.
Case mixed_case(Random &random) {
  const int low = random.integer(-1000, 0), high = random.integer(0, 250);
  return from_each(random, [&] {
    const auto coordinate = [&] {
      const int small = random.integer(-8, 8);
      return std::ldexp(small, random.coin() ? low : random.coin() ? high : (low + high) / 2);
    };
    return Point{coordinate(), coordinate()};
  });
}

std::ostream &operator<<(std::ostream &out, const Case &c) {
  out << std::hexfloat;
  for (const Point p : c.points)
    out << "(" << p.x << ", " << p.y << ") ";
  return out << "line " << c.line;
}

/// c as the corner of two split lines, c.x+ and c.y+.
void check_corner(const Case &given, const std::vector<mpz_class> &z) {
  const auto [a, b, c, unused] = given.points;
  if (a == b)
    return;
  const auto square = [&](std::size_t site) {
    const mpz_class x = z[2 * site] - z[4], y = z[2 * site + 1] - z[5];
    return mpz_class(x * x + y * y);
  };
  const mpz_class of_a = square(0), of_b = square(1);
  const bool a_is_nearer = of_a != of_b ? of_a < of_b : (z[0] != z[2] ? z[0] > z[2] : z[1] > z[3]);
  ASSERT_EQ(nearer(a, b, c), a_is_nearer) << given;
  ASSERT_EQ(exact::nearer(a, b, c), a_is_nearer) << given;
}

struct Checked {
  long orientation = 0, in_circle = 0, turn = 0, side = 0, zeros = 0;
};

void check_lines(const Case &given, const std::vector<mpz_class> &z, Axis axis, Checked &checked) {
  const auto [a, b, c, unused] = given.points;
  const auto site = [&](std::size_t i) {
    return axis == Axis::x ? oracle::Site<mpz_class>{z[2 * i], z[2 * i + 1]}
                           : oracle::Site<mpz_class>{z[2 * i + 1], z[2 * i]};
  };
  const oracle::Site<mpz_class> A = site(0), B = site(1), C = site(2);
  const SplitLine line{given.line, axis};
  const Sign turn = oracle::hull_turn(A, B, C, z[8]);
  const Sign plain = oracle::sign(oracle::hull_polynomial(A, B, C, z[8]));
  ASSERT_EQ(hull_turn(a, b, c, line), turn) << given;
  ASSERT_EQ(exact::hull_turn(a, b, c, line), turn) << given;
  ASSERT_EQ(hull_turn_unperturbed(a, b, c, line), plain) << given;
  ASSERT_EQ(exact::hull_turn_unperturbed(a, b, c, line), plain) << given;
  const mpz_class of_a = abs(A.x - z[8]), of_b = abs(B.x - z[8]);
  const bool a_is_nearer = of_a != of_b ? of_a < of_b : A.x > B.x;
  ASSERT_EQ(nearer(a, b, line), a_is_nearer) << given;
  ASSERT_EQ(exact::nearer(a, b, line), a_is_nearer) << given;
  ++checked.turn;
  checked.zeros += plain == Sign::zero;
  if (oracle::orientation(A, B, C) == Sign::zero)
    return;
  const bool left = oracle::circumcenter_is_left(A, B, C, z[8]);
  ASSERT_EQ(circumcenter_is_left(a, b, c, line), left) << given;
  ASSERT_EQ(exact::circumcenter_is_left(a, b, c, line), left) << given;
  ++checked.side;
}

void check(const Case &given, Checked &checked) {
  auto [a, b, c, d] = given.points;
  const std::array<double, 9> values = {a.x, a.y, b.x, b.y, c.x, c.y, d.x, d.y, given.line};
  const std::vector<mpz_class> z = oracle::as_integers(values);
  const oracle::Site<mpz_class> A{z[0], z[1]}, B{z[2], z[3]}, C{z[4], z[5]}, D{z[6], z[7]};
  const Sign turn = oracle::orientation(A, B, C);
  ASSERT_EQ(orientation(a, b, c), turn) << given;
  ASSERT_EQ(exact::orientation(a, b, c), turn) << given;
  ++checked.orientation;
  checked.zeros += turn == Sign::zero;
  check_corner(given, z);
  check_lines(given, z, Axis::x, checked);
  check_lines(given, z, Axis::y, checked);
  if (turn == Sign::zero || d == a || d == b || d == c)
    return;
  if (turn == Sign::negative)
    std::swap(b, c);
  const Sign inside = turn == Sign::positive ? oracle::in_circle<mpz_class>({A, B, C, D})
                                             : oracle::in_circle<mpz_class>({A, C, B, D});
  ASSERT_NE(inside, Sign::zero) << given;
  ASSERT_EQ(in_circle(a, b, c, d), inside) << given;
  ASSERT_EQ(exact::in_circle(a, b, c, d), inside) << given;
  ++checked.in_circle;
}

using Family = Case (*)(Random &);
constexpr std::array<Family, 10> families = {
    uniform_case,   decimal_case,        neighbouring_case, lattice_case, cocircular_case,
    collinear_case, rounded_circle_case, extreme_case,      scaled_case,  mixed_case};

/// Every third round of any family, the others of those whose integers stay short.
Case case_of_round(Random &random, long round) {
  const auto number = static_cast<std::size_t>(round / 3);
  return families[round % 3 == 0 ? number % families.size() : random.bits() % 7](random);
}

TEST(Predicates, agree_with_rational_arithmetic) {
  Random random(20240607);
  Checked checked;
  for (long round = 0; checked.in_circle < 1'000'000 && !HasFatalFailure(); ++round)
    check(case_of_round(random, round), checked);
  EXPECT_GE(checked.orientation, 1'000'000);
  EXPECT_GE(checked.turn, 1'000'000);
  EXPECT_GE(checked.side, 1'000'000);
  EXPECT_GE(checked.zeros, 100'000) << "the cases are meant to be hard";
}

/// What a predicate owes to every caller whatever the input: exchange of two arguments, rotation.
TEST(Predicates, keep_their_symmetries) {
  Random random(7);
  for (int round = 0; round < 100'000; ++round) {
    const Case given = case_of_round(random, round);
    const auto [a, b, c, d] = given.points;
    const Sign turn = orientation(a, b, c);
    ASSERT_EQ(orientation(b, c, a), turn);
    ASSERT_EQ(orientation(b, a, c), -turn);
    for (const Axis axis : {Axis::x, Axis::y}) {
      const SplitLine line{given.line, axis};
      ASSERT_EQ(hull_turn(b, c, a, line), hull_turn(a, b, c, line));
      ASSERT_EQ(hull_turn(c, b, a, line), -hull_turn(a, b, c, line));
      if (turn != Sign::zero) {
        ASSERT_EQ(circumcenter_is_left(c, b, a, line), circumcenter_is_left(a, b, c, line));
      }
    }
    if (turn != Sign::positive || d == a || d == b || d == c)
      continue;
    ASSERT_EQ(in_circle(b, c, a, d), in_circle(a, b, c, d));
    // If d lies beyond edge bc, it is inside the circle of abc exactly if a is inside that of cbd.
    if (orientation(c, b, d) == Sign::positive) {
      ASSERT_EQ(in_circle(c, b, d, a), in_circle(a, b, c, d)) << given;
    }
  }
}

/// On a full lattice every four corners of a square are a tie; the rule picks the diagonal for both
/// triangles.
TEST(Predicates, settle_squares_by_the_largest_corner) {
  const Point a{0, 0}, b{1, 0}, c{1, 1}, d{0, 1};
  EXPECT_EQ(in_circle(a, b, c, d), Sign::positive); // c rises highest, so a b c is not below d
  EXPECT_EQ(in_circle(a, b, d, c), Sign::negative); // and the diagonal is b d
}

} // namespace
} // namespace dovetail
