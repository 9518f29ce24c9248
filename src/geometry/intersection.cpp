// The intersection of two lines in integers, as in exact_predicates.cpp, and one rounding at the end.
//
// With D = (b - a) x (d - c) and N = (c - a) x (d - c) the point is a + (b - a) N / D, so its coordinates are
// quotients of (a D + (b - a) N) and D. For coordinates below 2^(64 W - 4) the numerators are below
// 2^(192 W - 8): 3 W words hold them.
#include "dovetail/geometry/intersection.hpp"

#include "fixed_integer.hpp"

#include <array>
#include <bit>
#include <cmath>

namespace dovetail {
namespace {

template <std::size_t Words> int bit_length(const FixedInteger<Words> &magnitude) {
  for (std::size_t i = Words; i-- > 0;)
    if (magnitude.words[i] != 0)
      return static_cast<int>(64 * i) + static_cast<int>(std::bit_width(magnitude.words[i]));
  return 0;
}

/// value * 2^shift, where there is room for it.
template <std::size_t Room, std::size_t Words>
FixedInteger<Room> shifted_left(const FixedInteger<Words> &value, int shift) {
  FixedInteger<Room> result;
  const auto words = static_cast<std::size_t>(shift / 64);
  const int bits = shift % 64;
  for (std::size_t i = 0; i < Words && i + words < Room; ++i) {
    result.words[i + words] |= value.words[i] << bits;
    if (bits > 0 && i + words + 1 < Room)
      result.words[i + words + 1] = value.words[i] >> (64 - bits);
  }
  return result;
}

template <std::size_t Words> FixedInteger<Words> magnitude_of(const FixedInteger<Words> &value) {
  return value.is_negative() ? FixedInteger<Words>{} - value : value;
}

/// numerator / denominator * 2^unit, rounded to nearest. Long division: 58 bits of the quotient, and one that
/// says whether anything is left.
template <std::size_t N, std::size_t D>
double rounded_quotient(const FixedInteger<N> &numerator, const FixedInteger<D> &denominator, int unit) {
  if (numerator.sign() == Sign::zero)
    return 0;
  const auto above = magnitude_of(numerator);
  const auto below = magnitude_of(denominator);
  const int difference = bit_length(above) - bit_length(below);
  // Both of one length, with a word of room: the quotient is between 1/2 and 2.
  constexpr std::size_t room = (N > D ? N : D) + 1;
  auto rest = shifted_left<room>(above, difference < 0 ? -difference : 0);
  const auto divisor = shifted_left<room>(below, difference > 0 ? difference : 0);
  constexpr int bits = 58;
  std::uint64_t quotient = 0;
  for (int i = 0; i < bits; ++i) {
    const FixedInteger<room> less = rest - divisor;
    quotient <<= 1;
    if (!less.is_negative()) {
      quotient |= 1;
      rest = less;
    }
    rest = rest + rest;
  }
  if (rest.sign() != Sign::zero)
    quotient |= 1;
  const double value = std::ldexp(static_cast<double>(quotient), difference - (bits - 1) + unit);
  return numerator.is_negative() == denominator.is_negative() ? value : -value;
}

template <std::size_t Words> Point intersection_of(const std::array<Scaled, 8> &values, int unit) {
  std::array<FixedInteger<Words>, 8> v;
  for (std::size_t i = 0; i < 8; ++i)
    v[i] = aligned<Words>(values[i], unit);
  const auto &[ax, ay, bx, by, cx, cy, dx, dy] = v;
  const auto along_x = bx - ax, along_y = by - ay, other_x = dx - cx, other_y = dy - cy;
  const auto denominator = along_x * other_y - along_y * other_x;
  const auto part = (cx - ax) * other_y - (cy - ay) * other_x;
  return {rounded_quotient(ax * denominator + along_x * part, denominator, unit),
          rounded_quotient(ay * denominator + along_y * part, denominator, unit)};
}

} // namespace

Point line_intersection(Point a, Point b, Point c, Point d) {
  const std::array<double, 8> coordinates{a.x, a.y, b.x, b.y, c.x, c.y, d.x, d.y};
  std::array<Scaled, 8> values;
  Extent extent;
  for (std::size_t i = 0; i < 8; ++i) {
    values[i] = scaled(coordinates[i]);
    extent.add(values[i]);
  }
  const int bits = extent.bits() + 4;
  if (bits <= 64)
    return intersection_of<1>(values, extent.low);
  if (bits <= 128)
    return intersection_of<2>(values, extent.low);
  if (bits <= 320)
    return intersection_of<5>(values, extent.low);
  return intersection_of<34>(values, extent.low);
}

} // namespace dovetail
