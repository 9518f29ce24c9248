/// Whose is it: from global numbers to slabs and ranks, without asking anybody.
///
/// Every rank knows where the sites and the triangles of every slab begin, and ranks own consecutive slabs
/// (first_slab_of_rank). So all of this is Local, and O(log slabs) unless it says otherwise. `ranks` is the
/// size of the communicator that the mesh is spread over. Numbers must be those of a site, or a triangle, of
/// the mesh.
#pragma once

#include "dovetail/distributed/mesh.hpp"

#include <vector>

namespace dovetail {

/// The rank that owns a slab, when `slabs` of them are spread over `ranks`. O(1).
constexpr int rank_of_slab(int slabs, int slab, int ranks) {
  return static_cast<int>(((static_cast<std::int64_t>(slab) + 1) * ranks - 1) / slabs);
}

int slab_of_site(const DistributedMesh &mesh, GlobalIndex site);
int slab_of_triangle(const DistributedMesh &mesh, GlobalIndex triangle);

/// The owner: for a ghost, the rank that it is a copy from.
int rank_of_site(const DistributedMesh &mesh, GlobalIndex site, int ranks);
int rank_of_triangle(const DistributedMesh &mesh, GlobalIndex triangle, int ranks);

/// The global number of a slab's vertex, own or ghost. O(1).
GlobalIndex number_of_vertex(const SlabMesh &slab, LocalIndex vertex);

/// The global number of the triangle beyond `side` = 3 * triangle + i, in whichever slab; `none` beyond the
/// hull. O(1) inside a slab, O(log border sides) on its border.
GlobalIndex number_of_neighbour(const SlabMesh &slab, LocalIndex side);

/// The other ranks that own a triangle with a side in common with one of `rank`'s, which is the rank whose
/// slabs `mesh` holds; ascending. If a is in the list of b, then b is in that of a. O(border sides).
/// Those whose sites are ghosts here are another set: see RankSites::neighbours.
std::vector<int> neighbour_ranks(const DistributedMesh &mesh, int rank, int ranks);

} // namespace dovetail
