#include "kernel_driver.hpp"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <array>

using namespace dovetail;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Delaunay_triangulation_2<Kernel>;
using Points = std::vector<Kernel::Point_2>;

int main(int argc, char **argv) {
  return benchmark::drive(
      argc, argv, "cgal",
      [](const std::vector<Point> &sites) {
        Points points;
        points.reserve(sites.size());
        for (const Point &site : sites)
          points.emplace_back(site.x, site.y);
        return points;
      },
      [](const Points &points) { return Mesh(points.begin(), points.end()); },
      [](const Points &, const Mesh &mesh) {
        const auto point_of = [](const auto &vertex) {
          return Point{vertex.point().x(), vertex.point().y()};
        };
        constexpr std::array<LocalIndex, 3> corners{0, 1, 2};
        benchmark::Result result{mesh.number_of_faces(), 0, mesh.is_valid()};
        for (auto v = mesh.finite_vertices_begin(); v != mesh.finite_vertices_end(); ++v)
          result.checksum += checksum_of_sites(std::array{point_of(*v)});
        for (auto f = mesh.finite_faces_begin(); f != mesh.finite_faces_end(); ++f)
          result.checksum += checksum_of_triangles(
              std::array{point_of(*f->vertex(0)), point_of(*f->vertex(1)), point_of(*f->vertex(2))}, corners);
        return result;
      });
}
