#include "kernel_driver.hpp"

#include "dovetail/mesh/split_path_recursion.hpp"
#include "dovetail/mesh/validate.hpp"

using namespace dovetail;
using Points = std::vector<Point>;

int main(int argc, char **argv) {
  return benchmark::drive(
      argc, argv, "split-path", [](Points points) { return points; },
      [](const Points &sites) { return delaunay_by_split_paths(sites); },
      [](const Points &sites, const Triangulation &mesh) {
        return benchmark::Result{mesh.corners.size() / 3,
                                 checksum_of_sites(sites) + checksum_of_triangles(sites, mesh.corners),
                                 validate(sites, mesh).valid()};
      });
}
