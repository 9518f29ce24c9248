#include "dovetail/mesh/space_filling_order.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <numeric>
#include <tuple>

namespace dovetail {
namespace {

constexpr unsigned curve_bits = 16;
constexpr std::uint32_t curve_side = 1U << curve_bits;

/// How far along Hilbert's curve through a square of curve_side x curve_side places x, y lies. Of each
/// square, the curve goes through the quarters lower left, upper left, upper right, lower right. In the upper
/// ones it looks the same; in the lower ones the axes are exchanged, and in the right one both are reversed
/// too. Written without branches, which would be mispredicted half the time.
std::uint32_t along_hilbert_curve(std::uint32_t x, std::uint32_t y) {
  std::uint32_t along = 0, exchanged = 0, reversed = 0;
  for (unsigned bit = curve_bits; bit-- > 0;) {
    const std::uint32_t a = ((x >> bit) & 1) ^ reversed, b = ((y >> bit) & 1) ^ reversed;
    const std::uint32_t right = a ^ (exchanged & (a ^ b)), upper = right ^ a ^ b;
    along = 4 * along + 2 * right + (right ^ upper);
    reversed ^= right & (upper ^ 1);
    exchanged ^= upper ^ 1;
  }
  return along;
}

/// The finaliser of splitmix64.
constexpr std::uint64_t mix(std::uint64_t v) {
  v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9U;
  v = (v ^ (v >> 27)) * 0x94d049bb133111ebU;
  return v ^ (v >> 31);
}

/// Coordinates halved, so that differences do not overflow.
struct Box {
  double x_low, y_low, scale;
};

struct Keyed {
  std::uint32_t along; ///< the curve
  LocalIndex point;
};

const Point &point_of(std::span<const Point> points, const Keyed &value) {
  return points[static_cast<std::size_t>(value.point)];
}

Box box_of(std::span<const Point> points, std::span<const Keyed> part) {
  const Point first = point_of(points, part.front());
  double x_low = first.x, x_high = first.x, y_low = first.y, y_high = first.y;
  for (const Keyed &value : part) {
    const Point p = point_of(points, value);
    x_low = std::min(x_low, p.x);
    x_high = std::max(x_high, p.x);
    y_low = std::min(y_low, p.y);
    y_high = std::max(y_high, p.y);
  }
  const double side = std::max(x_high / 2 - x_low / 2, y_high / 2 - y_low / 2);
  constexpr double most = std::numeric_limits<double>::max();
  return {x_low / 2, y_low / 2, side > 0 ? std::min((curve_side - 1) / side, most) : 0};
}

/// Rounded as it comes: it is an order only.
std::uint32_t place(double coordinate, double low, double scale) {
  const double at = (coordinate / 2 - low) * scale;
  return at > 0 ? static_cast<std::uint32_t>(std::min<double>(at, curve_side - 1)) : 0;
}

/// Along the curve; equal ones stay in their order, which ascends. A pass over all for each digit, the lowest
/// first.
void sort_along(std::span<Keyed> values, std::vector<Keyed> &spare) {
  constexpr unsigned digit_bits = 11;
  constexpr std::size_t digits = std::size_t{1} << digit_bits;
  if (values.size() < digits) { // fewer than there are counters
    std::ranges::sort(values, {}, [](const Keyed &value) { return std::tuple(value.along, value.point); });
    return;
  }
  if (spare.size() < values.size())
    spare.resize(values.size());
  std::span<Keyed> from = values, to = std::span(spare).first(values.size());
  for (unsigned shift = 0; shift < 2 * curve_bits; shift += digit_bits) {
    const auto digit = [shift](const Keyed &value) { return (value.along >> shift) % digits; };
    std::array<std::size_t, digits + 1> begin{};
    for (const Keyed &value : from)
      ++begin[digit(value) + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    for (const Keyed &value : from)
      to[begin[digit(value)]++] = value;
    std::swap(from, to);
  }
  if (from.data() != values.data())
    std::ranges::copy(from, values.begin());
}

/// Points that crowd in one place of the curve are ordered along one of their own there: however far the
/// outermost points are, of those in the middle each is near to the last.
void order_along_curve(std::span<const Point> points, std::span<Keyed> part, std::vector<Keyed> &spare) {
  constexpr std::size_t crowd = 16;
  if (part.size() < crowd)
    return;
  const Box box = box_of(points, part);
  for (Keyed &value : part) {
    const Point p = point_of(points, value);
    value.along = along_hilbert_curve(place(p.x, box.x_low, box.scale), place(p.y, box.y_low, box.scale));
  }
  sort_along(part, spare);
  if (part.front().along == part.back().along) // they are equal, or nearly, with differences that underflow
    return;
  for (auto begin = part.begin(); begin != part.end();) {
    const auto end = std::ranges::find_if(begin, part.end(),
                                          [&](const Keyed &value) { return value.along != begin->along; });
    order_along_curve(points, {begin, end}, spare);
    begin = end;
  }
}

} // namespace

std::vector<LocalIndex> space_filling_order(std::span<const Point> points) {
  const std::size_t n = points.size();
  // Of what is left, the last round has seven of eight points, and the round before as many of the others.
  constexpr unsigned growth_bits = 3;
  constexpr std::size_t first_round_points = 64;
  unsigned rounds = 1;
  while (n >> (growth_bits * rounds) >= first_round_points)
    ++rounds;
  const auto round_of = [&](std::size_t i) {
    const auto back = static_cast<unsigned>(std::countr_zero(mix(i + 1))) / growth_bits;
    return std::size_t{rounds - 1 - std::min(back, rounds - 1)};
  };
  std::vector<std::size_t> ends(rounds + 1, 0);
  for (std::size_t i = 0; i < n; ++i)
    ++ends[round_of(i) + 1];
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  const std::vector<std::size_t> begins = ends;
  std::vector<Keyed> order(n), spare;
  for (std::size_t i = 0; i < n; ++i)
    order[ends[round_of(i)]++].point = static_cast<LocalIndex>(i);
  for (std::size_t round = 0; round < rounds; ++round)
    order_along_curve(points, std::span(order).subspan(begins[round], begins[round + 1] - begins[round]),
                      spare);
  std::vector<LocalIndex> result(n);
  std::ranges::transform(order, result.begin(), &Keyed::point);
  return result;
}

} // namespace dovetail
