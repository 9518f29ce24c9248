/// The whole way from points, spread over the ranks in any way, to a distributed Delaunay mesh.
#pragma once

#include "dovetail/base/point_table.hpp"
#include "dovetail/comm/communicator.hpp"
#include "dovetail/comm/phases.hpp"
#include "dovetail/distributed/mesh.hpp"
#include "dovetail/distributed/slabs.hpp"

namespace dovetail {

struct TriangulateOptions {
  SlabOptions slabs;          ///< how to sort and cut; its progress hears of the later stages as well
  PhaseLog *phases = nullptr; ///< if set, the phases sort, split, triangulate and stitch are added to it
};

/// Collective. The canonical Delaunay triangulation of the distinct points: a function of their set alone,
/// whatever the number of ranks and slabs, the axis and the order. Zero triangles, of fewer than three sites
/// or collinear ones, are a valid mesh. Errors: those of sort_into_slabs and triangulate_region, on all
/// ranks alike.
DistributedMesh triangulate(const Communicator &comm, PointTable &&points,
                            const TriangulateOptions &options = {});

} // namespace dovetail
