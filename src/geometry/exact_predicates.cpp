// The exact stage: coordinates become integers in units of the smallest power of two among them, and the
// determinants are evaluated in integers wide enough for the actual span of exponents.
//
// Room, for coordinates below 2^(64 W - 4) in W words: differences stay below 2^(64 W - 3), a sum of two of
// them below 2^(64 W - 2), every polynomial of degree d below 2^(64 d W - 1), so d W words always hold it.

#include "dovetail/geometry/predicates.hpp"
#include "fixed_integer.hpp"

#include <algorithm>
#include <array>

namespace dovetail::exact {
namespace {

template <std::size_t Words, std::size_t Count> using Integers = std::array<FixedInteger<Words>, Count>;

template <std::size_t Words, std::size_t Count>
Integers<Words, Count> aligned_all(const std::array<Scaled, Count> &values, int unit) {
  Integers<Words, Count> result;
  for (std::size_t i = 0; i < Count; ++i)
    result[i] = aligned<Words>(values[i], unit);
  return result;
}

/// Calls `evaluate` with the values as integers of the first width that has room for them.
template <std::size_t Count, class Evaluate>
Sign with_integers(const std::array<double, Count> &values, Evaluate evaluate) {
  std::array<Scaled, Count> parts;
  Extent extent;
  for (std::size_t i = 0; i < Count; ++i) {
    parts[i] = scaled(values[i]);
    extent.add(parts[i]);
  }
  const int bits = extent.bits() + 4;
  if (bits <= 64)
    return evaluate(aligned_all<1>(parts, extent.low));
  if (bits <= 128)
    return evaluate(aligned_all<2>(parts, extent.low));
  if (bits <= 320)
    return evaluate(aligned_all<5>(parts, extent.low));
  return evaluate(aligned_all<34>(parts, extent.low)); // 2098 bits from the largest to the smallest double
}

/// Differences of neighbouring sites are often short although the coordinates are not: whether two-word ones
/// are below 2^61.
template <std::size_t Count> bool fit_one_word(const Integers<2, Count> &values) {
  return std::ranges::all_of(values, [](const FixedInteger<2> &value) {
    const auto low = static_cast<std::int64_t>(value.words[0]);
    const auto high = static_cast<std::int64_t>(value.words[1]);
    return high == low >> 63 && low > -(std::int64_t{1} << 61) && low < (std::int64_t{1} << 61);
  });
}

template <std::size_t Count> Integers<1, Count> first_words(const Integers<2, Count> &values) {
  Integers<1, Count> result;
  for (std::size_t i = 0; i < Count; ++i)
    result[i].words[0] = values[i].words[0];
  return result;
}

/// d = {ax, ay, bx, by}
template <std::size_t Words> Sign orientation_of(const Integers<Words, 4> &d) {
  return (d[0] * d[3] - d[1] * d[2]).sign();
}

enum class Corner { a, b, c, d };

Corner lexicographically_largest(Point a, Point b, Point c, Point d) {
  Corner corner = Corner::d;
  Point largest = d;
  const auto consider = [&](Point p, Corner candidate) {
    if (lexicographically_less(largest, p)) {
      largest = p;
      corner = candidate;
    }
  };
  consider(a, Corner::a);
  consider(b, Corner::b);
  consider(c, Corner::c);
  return corner;
}

/// v = {ax, ay, bx, by, cx, cy} relative to d. Where the determinant is zero its derivative in the height of
/// the largest site decides: for d that is minus the orientation of a, b, c, and for a corner its minor,
/// which is the orientation with d in that corner's place.
template <std::size_t Words> Sign in_circle_of(const Integers<Words, 6> &v, Corner largest) {
  if constexpr (Words == 2)
    if (fit_one_word(v))
      return in_circle_of(first_words(v), largest);
  const auto &[ax, ay, bx, by, cx, cy] = v;
  const auto bc = bx * cy - by * cx, ca = cx * ay - cy * ax, ab = ax * by - ay * bx;
  const Sign sign = ((ax * ax + ay * ay) * bc + (bx * bx + by * by) * ca + (cx * cx + cy * cy) * ab).sign();
  if (sign != Sign::zero)
    return sign;
  switch (largest) {
  case Corner::a:
    return bc.sign();
  case Corner::b:
    return ca.sign();
  case Corner::c:
    return ab.sign();
  default:
    return Sign::negative;
  }
}

/// d = {B, C, Xb, Xc, across a - m, across b - m, across c - m} as in filter::hull_turn
template <std::size_t Words> Sign hull_turn_of(const Integers<Words, 7> &d) {
  if constexpr (Words == 2)
    if (fit_one_word(d))
      return hull_turn_of(first_words(d));
  const auto &[B, C, Xb, Xc, from_a, from_b, from_c] = d;
  return (B * (C * C + Xc * (from_c + from_a)) - C * (B * B + Xb * (from_b + from_a))).sign();
}

} // namespace

Sign orientation(Point a, Point b, Point c) {
  const auto evaluate = []<std::size_t Words>(const Integers<Words, 6> &v) {
    return orientation_of<Words>({v[0] - v[4], v[1] - v[5], v[2] - v[4], v[3] - v[5]});
  };
  return with_integers<6>({a.x, a.y, b.x, b.y, c.x, c.y}, evaluate);
}

Sign in_circle(Point a, Point b, Point c, Point d) {
  const Corner largest = lexicographically_largest(a, b, c, d);
  const auto evaluate = [largest]<std::size_t Words>(const Integers<Words, 8> &v) {
    return in_circle_of<Words>({v[0] - v[6], v[1] - v[7], v[2] - v[6], v[3] - v[7], v[4] - v[6], v[5] - v[7]},
                               largest);
  };
  return with_integers<8>({a.x, a.y, b.x, b.y, c.x, c.y, d.x, d.y}, evaluate);
}

Sign hull_turn_unperturbed(Point a, Point b, Point c, SplitLine line) {
  const auto evaluate = []<std::size_t Words>(const Integers<Words, 7> &v) {
    return hull_turn_of<Words>(
        {v[3] - v[1], v[5] - v[1], v[2] - v[0], v[4] - v[0], v[0] - v[6], v[2] - v[6], v[4] - v[6]});
  };
  const Axis axis = line.axis;
  return with_integers<7>({across(a, axis), along(a, axis), across(b, axis), along(b, axis), across(c, axis),
                           along(c, axis), line.position},
                          evaluate);
}

Sign hull_turn(Point a, Point b, Point c, SplitLine line) {
  const Sign sign = exact::hull_turn_unperturbed(a, b, c, line);
  if (sign != Sign::zero)
    return sign;
  // Moving the line to m+ turns a zero the way the three turn in the plane of (across, along).
  const Sign turn = exact::orientation(a, b, c);
  return line.axis == Axis::x ? turn : -turn;
}

bool circumcenter_is_left(Point a, Point b, Point c, SplitLine line) {
  const Sign turn = exact::orientation(a, b, c);
  const Sign side = exact::hull_turn_unperturbed(a, b, c, line) * (line.axis == Axis::x ? turn : -turn);
  return side != Sign::negative;
}

bool nearer(Point a, Point b, SplitLine line) {
  const double of_a = across(a, line.axis), of_b = across(b, line.axis), m = line.position;
  if (of_a == of_b)
    return false;
  // The greater one is nearer unless the middle between the two is beyond m.
  const auto middle_from_line = []<std::size_t Words>(const Integers<Words, 3> &v) {
    return ((v[0] - v[2]) + (v[1] - v[2])).sign();
  };
  const bool greater_is_nearer = with_integers<3>({of_a, of_b, m}, middle_from_line) != Sign::positive;
  return greater_is_nearer == (of_a > of_b);
}

bool nearer(Point a, Point b, Point corner) {
  const auto farther = []<std::size_t Words>(const Integers<Words, 6> &v) {
    const auto &[ax, ay, bx, by, x, y] = v;
    return ((ax - bx) * ((ax - x) + (bx - x)) + (ay - by) * ((ay - y) + (by - y))).sign();
  };
  const Sign sign = with_integers<6>({a.x, a.y, b.x, b.y, corner.x, corner.y}, farther);
  return sign != Sign::zero ? sign == Sign::negative : lexicographically_less(b, a);
}

} // namespace dovetail::exact
