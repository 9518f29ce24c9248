/// The predicates once more, in integers (GMP's, or plain ones where they suffice) and written from the
/// definitions: what the real ones are tested against. Nothing here shares code or formulas with them.
#pragma once

#include "dovetail/base/types.hpp"
#include "dovetail/geometry/predicates.hpp"

#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

namespace dovetail::oracle {

template <class Number> struct Site {
  Number x, y;
  friend bool operator==(const Site &a, const Site &b) { return a.x == b.x && a.y == b.y; }
  friend bool operator<(const Site &a, const Site &b) { return a.x < b.x || (a.x == b.x && a.y < b.y); }
};

/// The doubles as integers, all divided by the same power of two.
inline std::vector<mpz_class> as_integers(std::span<const double> values) {
  int unit = 2000;
  for (const double value : values) {
    int exponent = 0;
    if (std::frexp(value, &exponent) != 0)
      unit = std::min(unit, exponent - 53);
  }
  std::vector<mpz_class> result;
  for (const double value : values) {
    int exponent = 0;
    const double fraction = std::frexp(value, &exponent);
    mpz_class integer(std::ldexp(fraction, 53));
    if (integer != 0)
      mpz_mul_2exp(integer.get_mpz_t(), integer.get_mpz_t(), static_cast<mp_bitcnt_t>(exponent - 53 - unit));
    result.push_back(std::move(integer));
  }
  return result;
}

template <class Number> Sign sign(const Number &value) { return sign_of(value); }

template <class Number>
Sign orientation(const Site<Number> &a, const Site<Number> &b, const Site<Number> &c) {
  return sign<Number>(a.x * b.y - a.y * b.x + b.x * c.y - b.y * c.x + c.x * a.y - c.y * a.x);
}

template <class Number> Number height(const Site<Number> &s) { return s.x * s.x + s.y * s.y; }

/// Rows (x, y, height) relative to the last site.
template <class Number>
Number determinant(const std::array<Site<Number>, 4> &s, const std::array<Number, 4> &heights) {
  std::array<std::array<Number, 3>, 3> r;
  for (std::size_t i = 0; i < 3; ++i)
    r[i] = {s[i].x - s[3].x, s[i].y - s[3].y, heights[i] - heights[3]};
  return r[0][0] * (r[1][1] * r[2][2] - r[1][2] * r[2][1]) -
         r[0][1] * (r[1][0] * r[2][2] - r[1][2] * r[2][0]) +
         r[0][2] * (r[1][0] * r[2][1] - r[1][1] * r[2][0]);
}

/// The heights are perturbed one by one, the largest site's first; the determinant is linear in each.
template <class Number> Sign in_circle(const std::array<Site<Number>, 4> &s) {
  std::array<Number, 4> heights = {height(s[0]), height(s[1]), height(s[2]), height(s[3])};
  const Number plain = determinant(s, heights);
  if (plain != 0)
    return sign(plain);
  std::array<std::size_t, 4> order = {0, 1, 2, 3};
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    return s[i].x != s[j].x ? s[i].x > s[j].x : s[i].y > s[j].y;
  });
  for (const std::size_t i : order) {
    heights[i] += 1;
    const Number slope = determinant(s, heights);
    heights[i] -= 1;
    if (slope != 0)
      return sign(slope);
  }
  return Sign::zero;
}

/// D(a, b, c, m) from the lifted heights.
template <class Number>
Number hull_polynomial(const Site<Number> &a, const Site<Number> &b, const Site<Number> &c, const Number &m) {
  const auto lift = [&](const Site<Number> &s) { return Number((s.x - m) * (s.x - m) + s.y * s.y); };
  const Number qa = lift(a), qb = lift(b), qc = lift(c);
  return (b.y - a.y) * (qc - qa) - (c.y - a.y) * (qb - qa);
}

/// D is linear in m: where it is zero, its growth decides what m+ does.
template <class Number>
Sign hull_turn(const Site<Number> &a, const Site<Number> &b, const Site<Number> &c, const Number &m) {
  const Number here = hull_polynomial(a, b, c, m);
  return sign<Number>(here != 0 ? here : Number(hull_polynomial<Number>(a, b, c, m + 1)));
}

/// The circumcenter is where the bisectors of ab and ac meet: Cramer's rule.
template <class Number>
bool circumcenter_is_left(const Site<Number> &a, const Site<Number> &b, const Site<Number> &c,
                          const Number &m) {
  const Number denominator = 2 * ((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y));
  const Number numerator = (height(b) - height(a)) * (c.y - a.y) - (height(c) - height(a)) * (b.y - a.y);
  return denominator > 0 ? numerator <= m * denominator : numerator >= m * denominator;
}

} // namespace dovetail::oracle
