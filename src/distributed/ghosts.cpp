#include "dovetail/distributed/ghosts.hpp"

#include "dovetail/distributed/ownership.hpp"

#include <algorithm>

namespace dovetail {
namespace {

/// The ghosts of this rank's slabs that are not its own sites, each once.
std::vector<GlobalIndex> foreign_sites(const DistributedMesh &mesh, GlobalIndex first, GlobalIndex beyond) {
  std::vector<GlobalIndex> numbers;
  for (const SlabMesh &slab : mesh.slabs)
    std::ranges::copy_if(slab.ghost_number, std::back_inserter(numbers),
                         [&](GlobalIndex number) { return number < first || number >= beyond; });
  std::ranges::sort(numbers);
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  return numbers;
}

/// One neighbour for each owner of a ghost, by ascending rank: ghosts ascend, and so do their owners.
std::vector<SiteNeighbour> owners_of(const std::vector<GlobalIndex> &ghosts, const DistributedMesh &mesh,
                                     int ranks) {
  std::vector<SiteNeighbour> owners;
  for (std::size_t g = 0; g < ghosts.size(); ++g) {
    const int rank = rank_of_site(mesh, ghosts[g], ranks);
    if (owners.empty() || owners.back().rank != rank)
      owners.push_back({rank, g, 0, 0, 0});
    ++owners.back().ghost_count;
  }
  return owners;
}

/// Enters who has asked for which of our sites. Letters come by ascending rank, and each ascends.
void add_askers(const std::vector<Incoming<GlobalIndex>> &letters, RankSites &sites) {
  for (const Incoming<GlobalIndex> &letter : letters) {
    auto at = std::ranges::lower_bound(sites.neighbours, letter.rank, {}, &SiteNeighbour::rank);
    if (at == sites.neighbours.end() || at->rank != letter.rank)
      at = sites.neighbours.insert(at, {letter.rank, 0, 0, 0, 0});
    at->first_shared = sites.shared.size();
    at->shared_count = letter.data.size();
    for (const GlobalIndex number : letter.data)
      sites.shared.push_back(static_cast<std::size_t>(number - sites.first_site));
  }
}

} // namespace

std::size_t RankSites::position_of(GlobalIndex number) const {
  const GlobalIndex own = number - first_site;
  if (own >= 0 && own < static_cast<GlobalIndex>(own_count))
    return static_cast<std::size_t>(own);
  const auto found = std::ranges::lower_bound(ghosts, number);
  assert(found != ghosts.end() && *found == number);
  return own_count + static_cast<std::size_t>(found - ghosts.begin());
}

RankSites rank_sites(const Communicator &comm, const DistributedMesh &mesh) {
  RankSites sites;
  std::vector<Outgoing<GlobalIndex>> questions;
  collectively(comm, [&] {
    const auto beyond = static_cast<std::size_t>(mesh.first_slab) + mesh.slabs.size();
    sites.first_site = mesh.site_offsets[static_cast<std::size_t>(mesh.first_slab)];
    sites.own_count = static_cast<std::size_t>(mesh.site_offsets[beyond] - sites.first_site);
    sites.ghosts = foreign_sites(mesh, sites.first_site, mesh.site_offsets[beyond]);
    sites.neighbours = owners_of(sites.ghosts, mesh, comm.size());
    for (const SiteNeighbour &owner : sites.neighbours)
      questions.push_back(
          {owner.rank, std::span(std::as_const(sites.ghosts)).subspan(owner.first_ghost, owner.ghost_count)});
  });
  const auto letters = sparse_exchange<GlobalIndex>(comm, questions);
  collectively(comm, [&] { add_askers(letters, sites); });
  return sites;
}

std::vector<std::size_t> positions_of_vertices(const RankSites &sites, const SlabMesh &slab) {
  std::vector<std::size_t> positions;
  const auto count = static_cast<LocalIndex>(slab.vertices.points.size());
  positions.reserve(slab.vertices.points.size());
  for (LocalIndex vertex = 0; vertex < count; ++vertex)
    positions.push_back(sites.position_of(number_of_vertex(slab, vertex)));
  return positions;
}

namespace ghosts {

bulk::SparseRound to_ghosts(const RankSites &sites, std::size_t element_bytes, const std::byte *shared,
                            std::byte *ghosts) {
  bulk::SparseRound round;
  for (const SiteNeighbour &n : sites.neighbours) {
    if (n.shared_count > 0)
      round.outgoing.push_back(
          {n.rank, shared + n.first_shared * element_bytes, static_cast<std::int64_t>(n.shared_count)});
    if (n.ghost_count > 0)
      round.incoming.push_back(
          {n.rank, ghosts + n.first_ghost * element_bytes, static_cast<std::int64_t>(n.ghost_count)});
  }
  round.requests.resize(round.outgoing.size() + round.incoming.size());
  return round;
}

bulk::SparseRound to_owners(const RankSites &sites, std::size_t element_bytes, const std::byte *ghosts,
                            std::byte *shared) {
  bulk::SparseRound round;
  for (const SiteNeighbour &n : sites.neighbours) {
    if (n.ghost_count > 0)
      round.outgoing.push_back(
          {n.rank, ghosts + n.first_ghost * element_bytes, static_cast<std::int64_t>(n.ghost_count)});
    if (n.shared_count > 0)
      round.incoming.push_back(
          {n.rank, shared + n.first_shared * element_bytes, static_cast<std::int64_t>(n.shared_count)});
  }
  round.requests.resize(round.outgoing.size() + round.incoming.size());
  return round;
}

} // namespace ghosts
} // namespace dovetail
