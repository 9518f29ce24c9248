#include "scale.hpp"

#include <algorithm>
#include <cmath>

namespace dovetail {

std::optional<int> scale_exponent(std::span<const Point> points) {
  constexpr double most = 0x1p200, least = 0x1p-200;
  double reach = 0;
  for (const Point &p : points)
    reach = std::max({reach, std::fabs(p.x), std::fabs(p.y)});
  if (reach == 0 || (reach <= most && reach >= least))
    return 0;
  const int exponent = std::ilogb(reach);
  const auto survives = [&](double value) {
    return std::ldexp(std::ldexp(value, -exponent), exponent) == value;
  };
  const bool possible =
      std::ranges::all_of(points, [&](const Point &p) { return survives(p.x) && survives(p.y); });
  return possible ? std::optional(exponent) : std::nullopt;
}

void scale(std::span<Point> points, int exponent) {
  for (Point &p : points)
    p = {std::ldexp(p.x, exponent), std::ldexp(p.y, exponent)};
}

} // namespace dovetail
