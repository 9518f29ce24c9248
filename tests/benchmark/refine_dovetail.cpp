#include "refine_driver.hpp"

#include "dovetail/mesh/constrain.hpp"
#include "dovetail/mesh/refine.hpp"
#include "dovetail/mesh/validate_domain.hpp"

using namespace dovetail;

namespace {

struct Meshed {
  Refined refined;
  std::vector<Segment> segments;
};

} // namespace

int main(int argc, char **argv) {
  return benchmark::drive(
      argc, argv, "dovetail",
      [](const benchmark::Task &task) {
        Constrained start =
            constrain(task.graph, {.outline = task.in_hull ? Outline::convex_hull : Outline::segments});
        std::vector<Segment> segments = task.graph.segments;
        segments.insert(segments.end(), start.hull_segments.begin(), start.hull_segments.end());
        Refined refined =
            refine(std::move(start.mesh), segments, {.min_angle = task.min_angle, .max_area = task.max_area});
        return Meshed{std::move(refined), std::move(segments)};
      },
      [](const benchmark::Task &task, const Meshed &meshed) {
        const DomainMesh &mesh = meshed.refined.mesh;
        return benchmark::Outcome{mesh.vertices.size(), mesh.region.size(),
                                  validate_domain(mesh, meshed.segments, task.min_angle).valid()};
      });
}
