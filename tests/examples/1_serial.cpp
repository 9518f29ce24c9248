// Points to triangles in one process. Needs the kernel alone: no MPI.
//
//     find_package(dovetail REQUIRED COMPONENTS kernel)
//     target_link_libraries(program PRIVATE dovetail::dovetail_kernel)
#include <dovetail/mesh/divide_and_conquer.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

/// The seeds of a sunflower: point k at the angle of k golden sections, at the radius sqrt(k).
std::vector<dovetail::Point> sunflower(int count) {
  std::vector<dovetail::Point> points;
  for (int k = 0; k < count; ++k) {
    const double angle = 2.399963229728653 * k, radius = std::sqrt(k);
    points.push_back({radius * std::cos(angle), radius * std::sin(angle)});
  }
  return points;
}

double length(dovetail::Point a, dovetail::Point b) { return std::hypot(b.x - a.x, b.y - a.y); }

double twice_the_area(dovetail::Point a, dovetail::Point b, dovetail::Point c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

int main() {
  std::vector<dovetail::Point> points = sunflower(1000);

  // The kernel takes distinct points. Sorting is one way to see to that; the order is yours to choose.
  std::ranges::sort(points, dovetail::lexicographically_less);
  points.erase(std::unique(points.begin(), points.end()), points.end());

  const dovetail::Triangulation mesh = dovetail::delaunay(points);

  // Triangle t has the corners 3 t, 3 t + 1 and 3 t + 2, counter-clockwise, and beyond the side across from
  // corner i there is the triangle neighbours[3 t + i], or none.
  double area = 0, perimeter = 0;
  int hull_edges = 0;
  for (std::size_t t = 0; t < mesh.corners.size(); t += 3) {
    const auto corner = [&](std::size_t i) {
      return points[static_cast<std::size_t>(mesh.corners[t + i % 3])];
    };
    area += twice_the_area(corner(0), corner(1), corner(2)) / 2;
    for (std::size_t i = 0; i < 3; ++i)
      if (mesh.neighbours[t + i] == dovetail::none) {
        ++hull_edges;
        perimeter += length(corner(i + 1), corner(i + 2));
      }
  }
  std::printf("%zu points, %d triangles\n", points.size(), static_cast<int>(mesh.triangle_count()));
  std::printf("convex hull: %d edges, perimeter %.3f, area %.3f\n", hull_edges, perimeter, area);
}
