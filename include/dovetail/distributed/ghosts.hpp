/// Values on the vertices of a distributed mesh, such as the unknowns of a solver: one array a rank, first
/// those of the sites that the rank owns and then those of its ghosts; and the two ways in which owners and
/// ghosts speak.
///
///     const RankSites sites = rank_sites(comm, mesh);
///     std::vector<double> values(sites.size());
///     ...                                          what this rank's triangles add to own sites and ghosts
///     add_ghosts<double>(comm, sites, values);     now the owners have the sums,
///     update_ghosts<double>(comm, sites, values);  and now the ghosts have them too
#pragma once

#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/exchange.hpp"
#include "dovetail/distributed/mesh.hpp"

#include <cassert>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace dovetail {

/// What this rank and another have of each other; one of the two may be nothing.
struct SiteNeighbour {
  int rank = 0;
  std::size_t first_ghost = 0; ///< in RankSites::ghosts: those that the other owns
  std::size_t ghost_count = 0;
  std::size_t first_shared = 0; ///< in RankSites::shared: those that are ghosts there
  std::size_t shared_count = 0;
};

/// The sites of a rank, each once; so a ghost of one of its slabs that belongs to another one of them counts
/// as own. Position p is the site first_site + p for p < own_count, and ghosts[p - own_count] from there on.
struct RankSites {
  GlobalIndex first_site = 0;
  std::size_t own_count = 0;
  std::vector<GlobalIndex> ghosts; ///< global numbers, ascending
  std::vector<std::size_t>
      shared; ///< positions of own sites that are ghosts elsewhere, neighbour by neighbour
  std::vector<SiteNeighbour> neighbours; ///< by ascending rank. If a is one of b's, then b is one of a's

  std::size_t size() const { return own_count + ghosts.size(); }
  /// Local. `number`: of one of these sites. O(1) for own sites, O(log ghosts) for others.
  std::size_t position_of(GlobalIndex number) const;
};

/// Collective. O(ghosts log ghosts), and a message to each owner of a ghost.
RankSites rank_sites(const Communicator &comm, const DistributedMesh &mesh);

/// The position of every vertex of one of this rank's slabs, in the order of its vertices. Local.
std::vector<std::size_t> positions_of_vertices(const RankSites &sites, const SlabMesh &slab);

namespace ghosts {
/// The messages from owners to ghosts, or from ghosts to owners. `shared` has an element for each of
/// sites.shared, `ghosts` one for each of sites.ghosts. Local.
bulk::SparseRound to_ghosts(const RankSites &sites, std::size_t element_bytes, const std::byte *shared,
                            std::byte *ghosts);
bulk::SparseRound to_owners(const RankSites &sites, std::size_t element_bytes, const std::byte *ghosts,
                            std::byte *shared);
} // namespace ghosts

/// Collective. Every ghost gets its owner's value. values: one for each position, on every rank.
/// A message to and from each neighbour, and an agreement (an all-reduce of an int) that there is memory.
template <Bulk T> void update_ghosts(const Communicator &comm, const RankSites &sites, std::span<T> values) {
  assert(values.size() == sites.size());
  std::vector<T> shared;
  bulk::SparseRound round = collectively(comm, [&] {
    shared.reserve(sites.shared.size());
    for (const std::size_t position : sites.shared)
      shared.push_back(values[position]);
    return ghosts::to_ghosts(sites, sizeof(T), bulk::bytes(std::as_const(shared).data()),
                             bulk::bytes(values.data() + sites.own_count));
  });
  bulk::deliver(comm, sizeof(T), round);
}

/// Collective. Every owner adds the values of its ghosts on other ranks to its own, by ascending rank; the
/// ghosts keep theirs. Cost as above.
template <Bulk T> void add_ghosts(const Communicator &comm, const RankSites &sites, std::span<T> values) {
  assert(values.size() == sites.size());
  std::vector<T> shared;
  bulk::SparseRound round = collectively(comm, [&] {
    shared.resize(sites.shared.size());
    return ghosts::to_owners(sites, sizeof(T), bulk::bytes(values.data() + sites.own_count),
                             bulk::bytes(shared.data()));
  });
  bulk::deliver(comm, sizeof(T), round);
  for (std::size_t i = 0; i < shared.size(); ++i)
    values[sites.shared[i]] += shared[i];
}

} // namespace dovetail
