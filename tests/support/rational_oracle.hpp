/// The predicates once more, in GMP integers and written from the definitions: what the real ones are tested
/// against. Nothing here shares code or formulas with them.
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

struct Site {
  mpz_class x, y;
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

inline Sign sign(const mpz_class &value) { return static_cast<Sign>(sgn(value)); }

inline Sign orientation(const Site &a, const Site &b, const Site &c) {
  return sign(a.x * b.y - a.y * b.x + b.x * c.y - b.y * c.x + c.x * a.y - c.y * a.x);
}

inline mpz_class height(const Site &s) { return s.x * s.x + s.y * s.y; }

/// Rows (x, y, height) relative to the last site.
inline mpz_class determinant(const std::array<Site, 4> &s, const std::array<mpz_class, 4> &heights) {
  std::array<std::array<mpz_class, 3>, 3> r;
  for (std::size_t i = 0; i < 3; ++i)
    r[i] = {s[i].x - s[3].x, s[i].y - s[3].y, heights[i] - heights[3]};
  return r[0][0] * (r[1][1] * r[2][2] - r[1][2] * r[2][1]) -
         r[0][1] * (r[1][0] * r[2][2] - r[1][2] * r[2][0]) +
         r[0][2] * (r[1][0] * r[2][1] - r[1][1] * r[2][0]);
}

/// The heights are perturbed one by one, the largest site's first; the determinant is linear in each.
inline Sign in_circle(const std::array<Site, 4> &s) {
  std::array<mpz_class, 4> heights = {height(s[0]), height(s[1]), height(s[2]), height(s[3])};
  const mpz_class plain = determinant(s, heights);
  if (plain != 0)
    return sign(plain);
  std::array<std::size_t, 4> order = {0, 1, 2, 3};
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    return s[i].x != s[j].x ? s[i].x > s[j].x : s[i].y > s[j].y;
  });
  for (const std::size_t i : order) {
    heights[i] += 1;
    const mpz_class slope = determinant(s, heights);
    heights[i] -= 1;
    if (slope != 0)
      return sign(slope);
  }
  return Sign::zero;
}

/// D(a, b, c, m) from the lifted heights.
inline mpz_class hull_polynomial(const Site &a, const Site &b, const Site &c, const mpz_class &m) {
  const auto lift = [&](const Site &s) { return mpz_class((s.x - m) * (s.x - m) + s.y * s.y); };
  const mpz_class qa = lift(a), qb = lift(b), qc = lift(c);
  return (b.y - a.y) * (qc - qa) - (c.y - a.y) * (qb - qa);
}

/// D is linear in m: where it is zero, its growth decides what m+ does.
inline Sign hull_turn(const Site &a, const Site &b, const Site &c, const mpz_class &m) {
  const mpz_class here = hull_polynomial(a, b, c, m);
  return sign(here != 0 ? here : mpz_class(hull_polynomial(a, b, c, m + 1)));
}

/// The circumcenter is where the bisectors of ab and ac meet: Cramer's rule.
inline bool circumcenter_is_left(const Site &a, const Site &b, const Site &c, const mpz_class &m) {
  const mpz_class denominator = 2 * ((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y));
  const mpz_class numerator = (height(b) - height(a)) * (c.y - a.y) - (height(c) - height(a)) * (b.y - a.y);
  return denominator > 0 ? numerator <= m * denominator : numerator >= m * denominator;
}

} // namespace dovetail::oracle
