/// Slabs that were triangulated apart become one mesh.
///
/// Every open side is matched with its twin by the numbers of its two sites, never by its position on a path:
/// an edge may lie on several consecutive paths (F8 in include/dovetail/README.md). First among the slabs of
/// a rank, then at a rendezvous, the rank that owns the lower of the two sites. What stays without a twin is
/// the convex hull.
#pragma once

#include "dovetail/comm/communicator.hpp"
#include "dovetail/distributed/triangulate_region.hpp"

#include <cstdint>
#include <functional>
#include <span>
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

/// An edge with the triangle on one of its sides. Twins have the same two sites.
struct OpenSide {
  GlobalIndex low, high; ///< global numbers of the edge's sites
  GlobalIndex triangle;  ///< global number
  std::int32_t slab;     ///< among this rank's
  LocalIndex side;       ///< in that slab
};

/// Local. Side `side` of this rank's slab k.
OpenSide open_side(const SlabMesh &slab, std::size_t k, LocalIndex side);

/// Collective. Fills border_sides and hull_edges. O(open sides * log).
void match_open_sides(const Communicator &comm, const Owners &owners, std::vector<OpenSide> open_sides,
                      DistributedMesh &mesh);
void match_open_sides(const Communicator &comm, const Owners &owners,
                      const std::vector<std::vector<LocalIndex>> &open_sides, DistributedMesh &mesh);

/// Collective. Completes the ghosts' input indices and attributes from the ranks that own their sites.
void complete_ghosts(const Communicator &comm, const Owners &owners, DistributedMesh &mesh);

/// For each of these own sites, ascending, one record: the bits of its input index and its attributes.
using SiteRecords = std::function<std::vector<std::uint64_t>(std::span<const GlobalIndex> numbers)>;
/// The same with own sites that are elsewhere.
void complete_ghosts(const Communicator &comm, const Owners &owners, const SiteRecords &records,
                     DistributedMesh &mesh);

/// Collective. Takes the sums over all ranks, and sees that the counts agree with Euler's relation: else an
/// Error of ErrorKind::fault.
void sum_up(const Communicator &comm, GlobalIndex path_sites, GlobalIndex candidate_sites,
            DistributedMesh &mesh);

} // namespace stitching
} // namespace dovetail
