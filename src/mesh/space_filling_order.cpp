#include "dovetail/mesh/space_filling_order.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <numeric>

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

Box box_of(std::span<const Point> points) {
  double x_low = points[0].x, x_high = x_low, y_low = points[0].y, y_high = y_low;
  for (const Point &p : points) {
    x_low = std::min(x_low, p.x);
    x_high = std::max(x_high, p.x);
    y_low = std::min(y_low, p.y);
    y_high = std::max(y_high, p.y);
  }
  const double side = std::max(x_high / 2 - x_low / 2, y_high / 2 - y_low / 2);
  return {x_low / 2, y_low / 2, side > 0 ? (curve_side - 1) / side : 0};
}

/// Rounded as it comes: it is an order only.
std::uint32_t place(double coordinate, double low, double scale) {
  const double at = (coordinate / 2 - low) * scale;
  return at > 0 ? static_cast<std::uint32_t>(std::min<double>(at, curve_side - 1)) : 0;
}

struct Keyed {
  std::uint64_t key;
  LocalIndex point;
};

/// By key; equal ones stay in their order. A pass over all for each digit, the lowest first.
void sort_by_key(std::vector<Keyed> &values, unsigned key_bits) {
  constexpr unsigned digit_bits = 11;
  constexpr std::size_t digits = std::size_t{1} << digit_bits;
  std::vector<Keyed> sorted(values.size());
  for (unsigned shift = 0; shift < key_bits; shift += digit_bits) {
    const auto digit = [shift](const Keyed &value) { return (value.key >> shift) % digits; };
    std::array<std::size_t, digits + 1> begin{};
    for (const Keyed &value : values)
      ++begin[digit(value) + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    for (const Keyed &value : values)
      sorted[begin[digit(value)]++] = value;
    values.swap(sorted);
  }
}

} // namespace

std::vector<LocalIndex> space_filling_order(std::span<const Point> points) {
  const std::size_t n = points.size();
  if (n == 0)
    return {};
  const Box box = box_of(points);
  // The last round has half of the points, the one before a quarter, and so on; the first few are one.
  constexpr unsigned first_round_sites = 64;
  const auto rounds = static_cast<unsigned>(std::bit_width(n / first_round_sites));
  std::vector<Keyed> order(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto back = std::min(rounds, static_cast<unsigned>(std::countr_zero(mix(i + 1))));
    const std::uint32_t along = along_hilbert_curve(place(points[i].x, box.x_low, box.scale),
                                                    place(points[i].y, box.y_low, box.scale));
    order[i] = {std::uint64_t{rounds - back} << (2 * curve_bits) | along, static_cast<LocalIndex>(i)};
  }
  sort_by_key(order, 2 * curve_bits + static_cast<unsigned>(std::bit_width(rounds)));
  std::vector<LocalIndex> result(n);
  std::ranges::transform(order, result.begin(), &Keyed::point);
  return result;
}

} // namespace dovetail
