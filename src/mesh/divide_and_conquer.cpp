#include "dovetail/mesh/divide_and_conquer.hpp"

#include "dovetail/base/error.hpp"
#include "merge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dovetail {
namespace {

using divide_and_conquer::ghost_vertex;
using divide_and_conquer::HalfEdge;
using divide_and_conquer::Hull;
using divide_and_conquer::less_along;
using divide_and_conquer::Sphere;
using divide_and_conquer::Vertex;

struct Numbered {
  Point point;
  LocalIndex index;
};

void cut(std::span<Numbered> sites, unsigned axis) {
  if (sites.size() <= 3)
    return;
  const std::size_t half = sites.size() / 2;
  std::nth_element(
      sites.begin(), sites.begin() + static_cast<std::ptrdiff_t>(half), sites.end(),
      [axis](const Numbered &a, const Numbered &b) { return less_along(a.point, b.point, axis); });
  cut(sites.first(half), 1 - axis);
  cut(sites.subspan(half), 1 - axis);
}

Hull conquer(const Sphere &sphere, Vertex first, Vertex count, unsigned axis) {
  if (count == 2)
    return sphere.two_sites(first);
  if (count == 3)
    return sphere.three_sites(first);
  const Vertex half = count / 2;
  const Hull left = conquer(sphere, first, half, 1 - axis);
  const Hull right = conquer(sphere, first + half, count - half, 1 - axis);
  return sphere.merge(left, right, axis, 6 * (first + half) - 6);
}

/// Drops the ghosts by moving triangles from the end into their places. Returns how many triangles stay.
LocalIndex drop_ghosts(Vertex *origin, HalfEdge *twin, LocalIndex triangles) {
  constexpr HalfEdge beyond = none;
  for (HalfEdge h = 0; h < 3 * triangles; h += 3)
    if (origin[h + 2] == ghost_vertex && twin[h] != beyond)
      twin[twin[h]] = beyond;
  LocalIndex hole = 0;
  LocalIndex end = triangles;
  for (;;) {
    while (hole < end && origin[3 * hole + 2] != ghost_vertex)
      ++hole;
    while (hole < end && origin[3 * end - 1] == ghost_vertex)
      --end;
    if (hole >= end)
      return end;
    --end;
    for (HalfEdge i = 0; i < 3; ++i) {
      const HalfEdge other = twin[3 * end + i];
      origin[3 * hole + i] = origin[3 * end + i];
      twin[3 * hole + i] = other;
      if (other != beyond)
        twin[other] = 3 * hole + i;
    }
    origin[3 * end + 2] = ghost_vertex;
  }
}

} // namespace

Triangulation delaunay(std::span<const Point> sites) {
  constexpr std::size_t most_sites = (std::size_t{1} << 31) / 6;
  if (sites.size() > most_sites)
    throw Error({ErrorKind::resource, "triangulation", "",
                 "a slab has more sites than 32-bit indices can number", "use more slabs"});
  if (sites.size() < 3)
    return {};
  const std::size_t n = sites.size();
  std::vector<Numbered> order(n);
  for (std::size_t i = 0; i < n; ++i)
    order[i] = {sites[i], static_cast<LocalIndex>(i)};
  cut(order, 0);
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Point> points(n + 1);
  points[0] = {nan, nan};
  double greatest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    points[i + 1] = order[i].point;
    greatest = std::max({greatest, std::fabs(order[i].point.x), std::fabs(order[i].point.y)});
  }

  Triangulation result;
  result.corners.resize(6 * n - 6);
  result.neighbours.resize(6 * n - 6);
  auto *origin = result.corners.data();
  auto *twin = result.neighbours.data();
  const double guard = greatest <= divide_and_conquer::greatest_filtered_coordinate
                           ? divide_and_conquer::sight_guard
                           : divide_and_conquer::no_filter;
  conquer({points.data() + 1, origin, twin, guard}, 0, static_cast<Vertex>(n), 0);
  const LocalIndex triangles = drop_ghosts(origin, twin, static_cast<LocalIndex>(2 * n - 2));
  result.corners.resize(3 * static_cast<std::size_t>(triangles));
  result.neighbours.resize(3 * static_cast<std::size_t>(triangles));
  for (std::size_t t = 0; t < result.corners.size(); t += 3) {
    LocalIndex across[3];
    for (std::size_t i = 0; i < 3; ++i) {
      result.corners[t + i] = order[static_cast<std::size_t>(result.corners[t + i])].index;
      across[i] = twin[t + i] == none ? none : twin[t + i] / 3;
    }
    result.neighbours[t] = across[1]; // half-edge i leaves corner i: it lies across from corner i + 2
    result.neighbours[t + 1] = across[2];
    result.neighbours[t + 2] = across[0];
  }
  return result;
}

} // namespace dovetail
