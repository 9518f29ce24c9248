#include "dovetail/mesh/refine.hpp"

#include "refinement.hpp"

#include "dovetail/base/error.hpp"

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

} // namespace

Refined refine(DomainMesh mesh, std::span<const Segment> segments, const RefineOptions &options) {
  check(options);
  Refinement refinement(std::move(mesh), segments, options);
  refinement.run();
  return refinement.result();
}

} // namespace dovetail
