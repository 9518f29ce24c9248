#include "insert_order.hpp"

#include "dovetail/mesh/insert.hpp"
#include "dovetail/mesh/validate.hpp"

using namespace dovetail;

namespace {

struct Mesh {
  std::vector<Point> sites;
  Triangulation triangles;
};

/// A function of its own, so that what is timed can be counted too.
[[gnu::noinline]] Mesh triangulate(const std::vector<Point> &points, benchmark::Way way) {
  Mesh mesh;
  if (way == benchmark::Way::batch) {
    insert_batch(mesh.sites, mesh.triangles, points);
  } else if (way == benchmark::Way::ordered) {
    insert_in_order(mesh.sites, mesh.triangles, points);
  } else {
    Cavity memory;
    for (const Point &point : points)
      insert(mesh.sites, mesh.triangles, point, none, memory);
  }
  return mesh;
}

} // namespace

/// insert_dovetail ordered|batch|random SOURCE N [REPEATS [SEED]]
int main(int argc, char **argv) {
  const benchmark::Way way = benchmark::way_named(argc > 1 ? argv[1] : "");
  return benchmark::drive(
      argc - 1, argv + 1, "dovetail",
      [way](const std::vector<Point> &points) { return benchmark::in_order(points, way); },
      [way](const std::vector<Point> &points) { return triangulate(points, way); },
      [](const std::vector<Point> &, const Mesh &mesh) {
        return benchmark::Result{mesh.triangles.corners.size() / 3,
                                 checksum_of_sites(mesh.sites) +
                                     checksum_of_triangles(mesh.sites, mesh.triangles.corners),
                                 validate(mesh.sites, mesh.triangles).valid()};
      });
}
