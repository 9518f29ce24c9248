#include "dovetail/distributed/triangulate.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/distributed/number_points.hpp"
#include "dovetail/distributed/regions.hpp"
#include "dovetail/distributed/stitch.hpp"
#include "dovetail/distributed/stream_mesh.hpp"
#include "dovetail/distributed/triangulate_region.hpp"

#include <fmt/format.h>

#include <utility>

namespace dovetail {
namespace {

template <class Work> auto measured(const TriangulateOptions &options, const char *name, Work &&work) {
  return options.phases ? options.phases->measure(name, work) : work();
}

/// Whoever hears of progress may throw to interrupt, so a phase begins where all can agree on that. Not so
/// triangulate: before it nobody waits for another half, and it says itself that it begins.
template <class Work>
auto phase(const Communicator &comm, const TriangulateOptions &options, const char *name, Work &&work) {
  return measured(options, name, [&] {
    collectively(comm, [&] { report_progress(options.slabs.progress, name, 0); });
    return work();
  });
}

Slabs sort(const Communicator &comm, PointTable &&points, const TriangulateOptions &options) {
  return phase(comm, options, "sort", [&] {
    check_points(comm, points, options.slabs.subject);
    return sort_into_slabs(comm, std::move(points), options.slabs);
  });
}

Region split(const Communicator &comm, Slabs &&slabs, const TriangulateOptions &options) {
  return phase(comm, options, "split", [&] { return split_into_regions(comm, std::move(slabs)); });
}

} // namespace

DistributedMesh triangulate(const Communicator &comm, PointTable &&points,
                            const TriangulateOptions &options) {
  Region region = split(comm, sort(comm, std::move(points), options), options);
  UnstitchedMesh local = measured(options, "triangulate", [&] {
    const auto purpose = [&] {
      return fmt::format("triangulating {} sites in {} slabs", region.slabs.sites.points.size(),
                         region.slabs.own_slab_count);
    };
    return collectively(comm, purpose, [&] {
      return triangulate_region(std::move(region), options.slabs.progress, options.kernel);
    });
  });
  return phase(comm, options, "stitch", [&] { return stitch(comm, std::move(local)); });
}

DistributedMesh triangulate_into(const Communicator &comm, PointTable &&points, SlabSink &sink,
                                 std::vector<CoordinateSystemRecord> coordinate_system,
                                 const TriangulateOptions &options) {
  return triangulate_into(comm, sort(comm, std::move(points), options), sink, std::move(coordinate_system),
                          options);
}

DistributedMesh triangulate_into(const Communicator &comm, Slabs &&slabs, SlabSink &sink,
                                 std::vector<CoordinateSystemRecord> coordinate_system,
                                 const TriangulateOptions &options) {
  return stream_mesh(comm, split(comm, std::move(slabs), options), sink,
                     {options.slabs.progress, options.phases, options.kernel, std::move(coordinate_system)});
}

DistributedMesh triangulate(const Communicator &comm, std::span<const Point> points,
                            const TriangulateOptions &options) {
  return triangulate(comm, number_points(comm, points), options);
}

} // namespace dovetail
