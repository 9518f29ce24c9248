#include "dovetail/mesh/space_filling_order.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>

namespace dovetail {
namespace {

constexpr std::uint32_t curve_side = 1U << 16;

/// How far along Hilbert's curve through a square of curve_side x curve_side places x, y lies.
std::uint32_t along_hilbert_curve(std::uint32_t x, std::uint32_t y) {
  std::uint32_t along = 0;
  for (std::uint32_t half = curve_side / 2; half > 0; half /= 2) {
    const bool right = (x & half) != 0, upper = (y & half) != 0;
    along = 4 * along + (right ? (upper ? 2 : 3) : (upper ? 1 : 0));
    if (!upper) { // the curve in the lower quarters is turned
      if (right) {
        x = curve_side - 1 - x;
        y = curve_side - 1 - y;
      }
      std::swap(x, y);
    }
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
    order[i] = {std::uint64_t{rounds - back} << 32 | along, static_cast<LocalIndex>(i)};
  }
  std::ranges::sort(order, [](const Keyed &a, const Keyed &b) {
    return a.key < b.key || (a.key == b.key && a.point < b.point);
  });
  std::vector<LocalIndex> result(n);
  std::ranges::transform(order, result.begin(), &Keyed::point);
  return result;
}

} // namespace dovetail
