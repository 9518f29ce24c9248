/// Regions to a mesh that never is in memory as a whole: slab after slab is triangulated, handed on and
/// dropped. What remains of a slab until the end is its border, O(path sites).
#pragma once

#include "dovetail/base/progress.hpp"
#include "dovetail/comm/phases.hpp"
#include "dovetail/distributed/kernel.hpp"
#include "dovetail/distributed/regions.hpp"
#include "dovetail/distributed/slab_sink.hpp"

#include <cstdint>
#include <vector>

namespace dovetail {

struct StreamOptions {
  Progress progress;          ///< stage "triangulate"
  PhaseLog *phases = nullptr; ///< if set, triangulate, write and stitch are added to it
  KernelChoice kernel;
  std::vector<CoordinateSystemRecord> coordinate_system; ///< of the input, carried along
  /// That this rank may use for its slabs, one at a time, and for all its borders; 0: any. With the paths
  /// known, a run that would need more is refused (Error, resource) before anything is written.
  std::int64_t memory_bytes = 0;
};

/// Collective. What F9 tells of the mesh, slab by slab, from sites and paths alone.
MeshOutline outline_of(const Communicator &comm, const Region &region);

/// Collective. The same mesh as stitch(triangulate_region(region)) makes, given to `sink`. Returned is all of
/// it but what is long: of every slab there are its numbers, ghosts, border sides and left path, and neither
/// own sites nor triangles. Errors as there.
///
/// Memory: that of the sites, if the region has them in memory, and what forecast.hpp says of a site of
/// the largest slab and of all paths.
DistributedMesh stream_mesh(const Communicator &comm, Region &&region, SlabSink &sink,
                            const StreamOptions &options = {});

} // namespace dovetail
