#include "path_travel.hpp"

#include "dovetail/comm/exchange.hpp"
#include "dovetail/comm/serialization.hpp"

#include <algorithm>
#include <numeric>

namespace boost::serialization {
template <class Archive> void serialize(Archive &archive, dovetail::PathSite &site, unsigned) {
  archive &site.point &site.number;
}
} // namespace boost::serialization
DOVETAIL_PLAIN_STRUCT(dovetail::PathSite)

namespace dovetail {
namespace {

/// So much fits into one archive, for which Boost.MPI finds memory by itself: little enough not to matter.
bool is_short(const Communicator &comm, std::int64_t sites) {
  constexpr std::int64_t most_bytes = std::int64_t{1} << 16;
  return sites * static_cast<std::int64_t>(sizeof(PathSite)) <= std::min(most_bytes, comm.chunk_bytes());
}

} // namespace

void broadcast_path(const Communicator &comm, Path &path, int root) {
  auto sites = static_cast<std::int64_t>(path.size());
  broadcast(comm, sites, root);
  bulk::make_room(comm, path, sites);
  if (is_short(comm, sites))
    broadcast(comm, path, root);
  else
    bulk::broadcast(comm, sizeof(PathSite), bulk::bytes(path.data()), sites, root);
}

Path gather_chains(const Communicator &comm, const Path &chain, int root) {
  const auto own = static_cast<std::int64_t>(chain.size());
  const std::vector<std::int64_t> counts = all_gather(comm, own);
  const std::int64_t sites = std::accumulate(counts.begin(), counts.end(), std::int64_t{0});
  Path chains;
  bulk::make_room(comm, chains, comm.rank() == root ? sites : 0);
  if (is_short(comm, sites)) {
    auto place = chains.begin();
    for (const Path &one : gather(comm, chain, root))
      place = std::copy(one.begin(), one.end(), place);
  } else {
    bulk::gather(comm, sizeof(PathSite), bulk::bytes(chain.data()), own, bulk::bytes(chains.data()), counts,
                 root);
  }
  return chains;
}

} // namespace dovetail
