#include "refine_driver.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesh_size_criteria_2.h>
#include <CGAL/Delaunay_mesh_vertex_base_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

using namespace dovetail;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertex = CGAL::Delaunay_mesh_vertex_base_2<Kernel>;
using Face = CGAL::Delaunay_mesh_face_base_2<Kernel>;
using Mesh =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<Vertex, Face>>;
using Handle = Mesh::Vertex_handle;

namespace {

std::unique_ptr<Mesh> constrained(const benchmark::Task &task) {
  auto mesh = std::make_unique<Mesh>();
  if (task.graph.segments.empty()) {
    std::vector<Kernel::Point_2> points;
    points.reserve(task.graph.vertices.size());
    for (const Point &p : task.graph.vertices)
      points.emplace_back(p.x, p.y);
    mesh->insert(points.begin(), points.end());
  } else {
    std::vector<Handle> handles;
    for (const Point &p : task.graph.vertices)
      handles.push_back(mesh->insert(Kernel::Point_2(p.x, p.y)));
    for (const Segment &s : task.graph.segments)
      mesh->insert_constraint(handles[static_cast<std::size_t>(s.from)],
                              handles[static_cast<std::size_t>(s.to)]);
  }
  if (task.in_hull) {
    std::vector<std::pair<Handle, Handle>> hull;
    auto at = mesh->incident_vertices(mesh->infinite_vertex()), begin = at;
    do {
      const Handle from = at++;
      hull.emplace_back(from, at);
    } while (at != begin);
    for (const auto &[from, to] : hull)
      mesh->insert_constraint(from, to);
  }
  return mesh;
}

template <class Criteria> void refine(const benchmark::Task &task, Mesh &mesh, const Criteria &criteria) {
  std::vector<Kernel::Point_2> holes;
  for (const Point &p : task.graph.holes)
    holes.emplace_back(p.x, p.y);
  CGAL::Delaunay_mesher_2<Mesh, Criteria> mesher(mesh, criteria);
  mesher.set_seeds(holes.begin(), holes.end());
  mesher.refine_mesh();
}

} // namespace

int main(int argc, char **argv) {
  return benchmark::drive(
      argc, argv, "cgal",
      [](const benchmark::Task &task) {
        auto mesh = constrained(task);
        const double sine = std::sin(task.min_angle * std::numbers::pi / 180);
        // CGAL bounds edges. With this bound it makes about as many triangles as others for the area.
        const double longest = 1.8 * std::sqrt(task.max_area);
        refine(task, *mesh, CGAL::Delaunay_mesh_size_criteria_2<Mesh>(sine * sine, longest));
        return mesh;
      },
      [](const benchmark::Task &, const std::unique_ptr<Mesh> &mesh) {
        const auto faces = mesh->finite_face_handles();
        const auto inside =
            std::count_if(faces.begin(), faces.end(), [](const auto &face) { return face->is_in_domain(); });
        return benchmark::Outcome{mesh->number_of_vertices(), static_cast<std::size_t>(inside),
                                  mesh->is_valid()};
      });
}
