/// The whole way from points, spread over the ranks in any way, to a distributed Delaunay mesh.
#pragma once

#include "dovetail/base/error.hpp"
#include "dovetail/base/point_table.hpp"
#include "dovetail/comm/communicator.hpp"
#include "dovetail/comm/phases.hpp"
#include "dovetail/distributed/kernel.hpp"
#include "dovetail/distributed/mesh.hpp"
#include "dovetail/distributed/slab_sink.hpp"
#include "dovetail/distributed/slabs.hpp"

#include <span>
#include <vector>

namespace dovetail {

struct TriangulateOptions {
  SlabOptions slabs;          ///< how to sort and cut; its progress hears of the later stages as well
  PhaseLog *phases = nullptr; ///< if set, the phases sort, split, triangulate and stitch are added to it
  KernelChoice kernel;        ///< for the triangles of slabs; no influence on the mesh
};

/// Collective. The canonical Delaunay triangulation of the distinct points: a function of their set alone,
/// whatever the number of ranks and slabs, the axis and the order. Zero triangles, of fewer than three sites
/// or collinear ones, are a valid mesh.
///
/// points: any distribution over the ranks, none on some included; input indices distinct over all ranks.
/// Errors, thrown as the same Error on all ranks: those of check_points, sort_into_slabs and
/// triangulate_region; memory that runs out on any rank.
DistributedMesh triangulate(const Communicator &comm, PointTable &&points,
                            const TriangulateOptions &options = {});

/// Collective. The same mesh, given to `sink` slab by slab (stream_mesh), of points in memory or of slabs
/// that wait on disk. Of the slabs that are returned only the borders are left.
DistributedMesh triangulate_into(const Communicator &comm, PointTable &&points, SlabSink &sink,
                                 std::vector<CoordinateSystemRecord> coordinate_system,
                                 const TriangulateOptions &options = {});
DistributedMesh triangulate_into(const Communicator &comm, Slabs &&slabs, SlabSink &sink,
                                 std::vector<CoordinateSystemRecord> coordinate_system,
                                 const TriangulateOptions &options = {});

/// Collective. The same of plain points, which get their input indices by number_points: those of the first
/// rank from 0 on, then those of the second, and so on.
DistributedMesh triangulate(const Communicator &comm, std::span<const Point> points,
                            const TriangulateOptions &options = {});

} // namespace dovetail
