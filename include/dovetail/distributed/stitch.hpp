/// Slabs that were triangulated apart become one mesh.
///
/// Every open side is matched with its twin by the numbers of its two sites, never by its position on a path:
/// an edge may lie on several consecutive paths (F8 in include/dovetail/README.md). First among the slabs of
/// a rank, then at a rendezvous, the rank that owns the lower of the two sites. What stays without a twin is
/// the convex hull.
#pragma once

#include "dovetail/comm/communicator.hpp"
#include "dovetail/distributed/triangulate_region.hpp"

#include <vector>

namespace dovetail {

/// Collective. Numbers the triangles, joins the slabs, brings the ghosts what came with their sites, sums up
/// the checksum and the hull. Sends O(path sites) of data to the few ranks that own those sites, and one
/// count a slab to all. Euler's relation is checked: a violation is a bug, an Error of
/// ErrorKind::fault.
DistributedMesh stitch(const Communicator &comm, UnstitchedMesh &&unstitched);

namespace stitching {

/// The first site of every rank: who owns which. The same on all ranks.
struct Owners {
  std::vector<GlobalIndex> first_site; ///< of rank r; at the end the number of sites
  int rank_of_site(GlobalIndex number) const;
};

/// Collective.
Owners owners(const Communicator &comm, const DistributedMesh &mesh);

/// Collective. Fills triangle_offsets and every slab's first_triangle.
void number_triangles(const Communicator &comm, DistributedMesh &mesh);

/// Collective. Fills border_sides and hull_edges. O(open sides * log).
void match_open_sides(const Communicator &comm, const Owners &owners,
                      const std::vector<std::vector<LocalIndex>> &open_sides, DistributedMesh &mesh);

/// Collective. Completes the ghosts' input indices and attributes from the ranks that own their sites.
void complete_ghosts(const Communicator &comm, const Owners &owners, DistributedMesh &mesh);

} // namespace stitching
} // namespace dovetail
