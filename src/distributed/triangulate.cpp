#include "dovetail/distributed/triangulate.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/distributed/number_points.hpp"
#include "dovetail/distributed/regions.hpp"
#include "dovetail/distributed/stitch.hpp"
#include "dovetail/distributed/triangulate_region.hpp"

#include <fmt/format.h>

#include <utility>

namespace dovetail {

DistributedMesh triangulate(const Communicator &comm, PointTable &&points,
                            const TriangulateOptions &options) {
  const Progress &progress = options.slabs.progress;
  const auto measured = [&](const char *name, auto &&work) {
    return options.phases ? options.phases->measure(name, work) : work();
  };
  // Whoever hears of progress may throw to interrupt, so a phase begins where all can agree on that. Not so
  // triangulate: before it nobody waits for another half, and it says itself that it begins.
  const auto phase = [&](const char *name, auto &&work) {
    return measured(name, [&] {
      collectively(comm, [&] { report_progress(progress, name, 0); });
      return work();
    });
  };
  Slabs slabs = phase("sort", [&] {
    check_points(comm, points, options.slabs.subject);
    return sort_into_slabs(comm, std::move(points), options.slabs);
  });
  Region region = phase("split", [&] { return split_into_regions(comm, std::move(slabs)); });
  UnstitchedMesh local = measured("triangulate", [&] {
    const auto purpose = [&] {
      return fmt::format("triangulating {} sites in {} slabs", region.slabs.sites.points.size(),
                         region.slabs.own_slab_count);
    };
    return collectively(comm, purpose,
                        [&] { return triangulate_region(std::move(region), progress, options.kernel); });
  });
  return phase("stitch", [&] { return stitch(comm, std::move(local)); });
}

DistributedMesh triangulate(const Communicator &comm, std::span<const Point> points,
                            const TriangulateOptions &options) {
  return triangulate(comm, number_points(comm, points), options);
}

} // namespace dovetail
