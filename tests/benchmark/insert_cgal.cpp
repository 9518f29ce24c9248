#include "insert_order.hpp"

#include "cgal_result.hpp"

using namespace dovetail;
using benchmark::CgalMesh;
using benchmark::CgalPoints;

namespace {

/// A function of its own, so that what is timed can be counted too.
[[gnu::noinline]] CgalMesh triangulate(const CgalPoints &points, benchmark::Way way) {
  if (way == benchmark::Way::batch)
    return {points.begin(), points.end()}; // which sorts along Hilbert's curve in rounds as well
  CgalMesh mesh;
  CgalMesh::Face_handle hint;
  for (const auto &point : points) {
    const auto vertex = mesh.insert(point, hint);
    if (way == benchmark::Way::ordered)
      hint = vertex->face();
  }
  return mesh;
}

} // namespace

/// insert_cgal ordered|batch|random SOURCE N [REPEATS [SEED]]
int main(int argc, char **argv) {
  const benchmark::Way way = benchmark::way_named(argc > 1 ? argv[1] : "");
  return benchmark::drive(
      argc - 1, argv + 1, "cgal",
      [way](const std::vector<Point> &points) {
        return benchmark::cgal_points(benchmark::in_order(points, way));
      },
      [way](const CgalPoints &points) { return triangulate(points, way); },
      [](const CgalPoints &, const CgalMesh &mesh) { return benchmark::result_of(mesh); });
}
