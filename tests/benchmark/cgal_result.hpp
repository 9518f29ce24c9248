/// CGAL's Delaunay triangulation as the drivers use it.
#pragma once

#include "kernel_driver.hpp"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <array>

namespace dovetail::benchmark {

using CgalKernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalMesh = CGAL::Delaunay_triangulation_2<CgalKernel>;
using CgalPoints = std::vector<CgalKernel::Point_2>;

inline CgalPoints cgal_points(const std::vector<Point> &sites) {
  CgalPoints points;
  points.reserve(sites.size());
  for (const Point &site : sites)
    points.emplace_back(site.x, site.y);
  return points;
}

inline Result result_of(const CgalMesh &mesh) {
  const auto point_of = [](const auto &vertex) { return Point{vertex.point().x(), vertex.point().y()}; };
  constexpr std::array<LocalIndex, 3> corners{0, 1, 2};
  Result result{mesh.number_of_faces(), 0, mesh.is_valid()};
  for (auto v = mesh.finite_vertices_begin(); v != mesh.finite_vertices_end(); ++v)
    result.checksum += checksum_of_sites(std::array{point_of(*v)});
  for (auto f = mesh.finite_faces_begin(); f != mesh.finite_faces_end(); ++f)
    result.checksum += checksum_of_triangles(
        std::array{point_of(*f->vertex(0)), point_of(*f->vertex(1)), point_of(*f->vertex(2))}, corners);
  return result;
}

} // namespace dovetail::benchmark
