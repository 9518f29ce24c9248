#include "support/small_sites_oracle.hpp"

#include <vector>

namespace dovetail::testing {
namespace {

__extension__ using Wide = __int128;

struct Lifted {
  Wide x, y, z;
};

/// Twice the signed area.
Wide area(const Lifted &a, const Lifted &b, const Lifted &c) {
  return a.x * b.y - a.y * b.x + b.x * c.y - b.y * c.x + c.x * a.y - c.y * a.x;
}

/// The determinant | x y z 1 | of four sites is linear in their heights z: this is the factor of the height
/// of the one in row `row`.
Wide height_factor(const std::array<Lifted, 4> &p, std::size_t row) {
  std::array<Lifted, 3> others;
  std::size_t count = 0;
  for (std::size_t i = 0; i < 4; ++i)
    if (i != row)
      others[count++] = p[i];
  const Wide minor = area(others[0], others[1], others[2]);
  return row % 2 == 0 ? minor : -minor;
}

/// Is p[3] above the plane through the other three, after perturbation?
bool is_above(const std::array<Lifted, 4> &p) {
  Wide determinant = 0;
  for (std::size_t i = 0; i < 4; ++i)
    determinant += p[i].z * height_factor(p, i);
  if (determinant == 0) {
    std::size_t largest = 0;
    for (std::size_t i = 1; i < 4; ++i)
      if (p[i].x > p[largest].x || (p[i].x == p[largest].x && p[i].y > p[largest].y))
        largest = i;
    determinant = height_factor(p, largest);
  }
  // Raising p[3] changes the determinant by its factor: it is above if the signs agree.
  return (determinant > 0) == (height_factor(p, 3) > 0);
}

} // namespace

std::set<Triple> delaunay_by_definition(std::span<const IntegerSite> sites) {
  std::vector<Lifted> lifted;
  for (const IntegerSite &site : sites) {
    const Wide x = site.x - sites[0].x;
    const Wide y = site.y - sites[0].y;
    lifted.push_back({x, y, x * x + y * y});
  }
  const auto at = [&](int i) { return lifted[static_cast<std::size_t>(i)]; };
  const int n = static_cast<int>(sites.size());
  std::set<Triple> triangles;
  for (int a = 0; a < n; ++a)
    for (int b = a + 1; b < n; ++b)
      for (int c = b + 1; c < n; ++c) {
        bool lowest = area(at(a), at(b), at(c)) != 0;
        for (int d = 0; d < n && lowest; ++d)
          lowest = d == a || d == b || d == c || is_above({at(a), at(b), at(c), at(d)});
        if (lowest)
          triangles.insert({a, b, c});
      }
  return triangles;
}

} // namespace dovetail::testing
