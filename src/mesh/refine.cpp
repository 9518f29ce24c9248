#include "dovetail/mesh/refine.hpp"

#include "refinement.hpp"
#include "scale.hpp"

#include "dovetail/base/error.hpp"

#include <cmath>
#include <fmt/core.h>

namespace dovetail {
namespace {

void check(const RefineOptions &options) {
  const auto refuse = [](std::string subject, std::string what, std::string remedy) {
    throw Error({ErrorKind::usage, std::move(subject), "", std::move(what), std::move(remedy)});
  };
  if (!(options.min_angle >= 0 && options.min_angle <= most_min_angle))
    refuse("minimum angle", fmt::format("{} degrees", options.min_angle),
           fmt::format("ask for 0 to {}", most_min_angle));
  for (const auto &[name, value] :
       {std::pair{"maximum area", options.max_area}, std::pair{"growth", options.growth},
        std::pair{"minimum edge", options.min_edge}})
    if (!(value >= 0))
      refuse(name, fmt::format("{}", value), "ask for a positive number, or 0 for no limit");
}

/// New points have to survive the way back.
int exponent_for(std::span<const Point> vertices) {
  constexpr int least = -900;
  const std::optional<int> exponent = scale_exponent(vertices);
  if (!exponent || *exponent < least)
    throw Error(
        {ErrorKind::input, "coordinates", "",
         exponent ? "they are so small that doubles have no room for new vertices"
                  : "the largest and the smallest differ so much that lengths cannot be compared",
         exponent ? "multiply them by a power of two" : "set to zero those that are next to nothing"});
  return *exponent;
}

/// Lengths as they are where all coordinates are divided by 2^exponent.
RefineOptions scaled(RefineOptions options, int exponent) {
  options.min_edge = std::ldexp(options.min_edge, -exponent);
  options.max_area = std::ldexp(options.max_area, -2 * exponent);
  for (double &area : options.max_area_of_region)
    area = std::ldexp(area, -2 * exponent);
  return options;
}

Refined run(DomainMesh mesh, std::span<const Segment> segments, const RefineOptions &options,
            const SizeField *size_field) {
  Refinement refinement(std::move(mesh), segments, options, size_field);
  refinement.run();
  return refinement.result();
}

/// First without the size field, which is made of what the boundary has become by then.
Refined run_with_field(DomainMesh mesh, std::span<const Segment> segments, RefineOptions options) {
  const LocalIndex given = mesh.triangles.triangle_count();
  const Progress whole = options.progress;
  options.progress = part_of_stage(whole, 0, 0.5);
  Refined before = run(std::move(mesh), segments, options, nullptr);
  options.progress = part_of_stage(whole, 0.5, 1);
  if (options.locked) // triangles with locked edges are still what they were, and no new one has any
    options.locked = [given, locked = options.locked](LocalIndex t, int side) {
      return t < given && locked(t, side);
    };
  const SizeField field(before.mesh, options.lone_vertices, options.growth);
  Refined result = run(std::move(before.mesh), segments, options, &field);
  result.points_inside += before.points_inside;
  result.points_on_segments += before.points_on_segments;
  return result;
}

} // namespace

Refined refine(DomainMesh mesh, std::span<const Segment> segments, const RefineOptions &options) {
  check(options);
  const int exponent = exponent_for(mesh.vertices);
  if (exponent != 0)
    scale(mesh.vertices, -exponent);
  const RefineOptions scaled_options = scaled(options, exponent);
  Refined result = options.growth > 0 ? run_with_field(std::move(mesh), segments, scaled_options)
                                      : run(std::move(mesh), segments, scaled_options, nullptr);
  if (exponent == 0)
    return result;
  scale(result.mesh.vertices, exponent);
  for (LeftTriangle &left : result.left_triangles) {
    scale(std::span(&left.place, 1), exponent);
    left.area = std::ldexp(left.area, 2 * exponent);
  }
  return result;
}

} // namespace dovetail
