/// Where the split paths run.
#pragma once

#include "dovetail/comm/communicator.hpp"
#include "dovetail/distributed/mesh.hpp"

#include <vector>

namespace dovetail {

/// Collective. For each of this rank's slabs the positions of the sites of its left path, in its order; empty
/// for slab 0. A path's sites belong to any slab, so their owners are asked. The layout must be sound.
std::vector<std::vector<Point>> path_points(const Communicator &comm, const DistributedMesh &mesh);

} // namespace dovetail
