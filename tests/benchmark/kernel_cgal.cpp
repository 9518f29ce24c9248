#include "cgal_result.hpp"

using namespace dovetail;
using benchmark::CgalMesh;
using benchmark::CgalPoints;

int main(int argc, char **argv) {
  return benchmark::drive(
      argc, argv, "cgal", [](const std::vector<Point> &sites) { return benchmark::cgal_points(sites); },
      [](const CgalPoints &points) { return CgalMesh(points.begin(), points.end()); },
      [](const CgalPoints &, const CgalMesh &mesh) { return benchmark::result_of(mesh); });
}
