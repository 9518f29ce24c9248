#include "dovetail/distributed/triangulate.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/distributed/regions.hpp"
#include "dovetail/distributed/stitch.hpp"
#include "dovetail/distributed/triangulate_region.hpp"

#include <utility>

namespace dovetail {

DistributedMesh triangulate(const Communicator &comm, PointTable &&points,
                            const TriangulateOptions &options) {
  const auto phase = [&](const char *name, auto &&work) {
    report_progress(options.slabs.progress, name, 0);
    return options.phases ? options.phases->measure(name, work) : work();
  };
  Slabs slabs = phase("sort", [&] { return sort_into_slabs(comm, std::move(points), options.slabs); });
  Region region = phase("split", [&] { return split_into_regions(comm, std::move(slabs)); });
  UnstitchedMesh local = phase("triangulate", [&] {
    return collectively(comm, [&] { return triangulate_region(std::move(region), options.slabs.progress); });
  });
  return phase("stitch", [&] { return stitch(comm, std::move(local)); });
}

} // namespace dovetail
