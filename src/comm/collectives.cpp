#include "dovetail/comm/collectives.hpp"

#include <bit>

namespace dovetail::traffic {
namespace {

int tree_depth(int ranks) { return static_cast<int>(std::bit_width(static_cast<unsigned>(ranks - 1))); }

void count(const Communicator &comm, std::int64_t messages, std::int64_t bytes) {
  comm.traffic().messages_sent += messages;
  comm.traffic().bytes_sent += bytes;
}

} // namespace

void count_all_reduce(const Communicator &comm, std::int64_t bytes) {
  const int depth = tree_depth(comm.size());
  count(comm, depth, depth * bytes);
}

void count_all_gather(const Communicator &comm, std::int64_t bytes) {
  count(comm, tree_depth(comm.size()), (comm.size() - 1) * bytes);
}

void count_broadcast(const Communicator &comm, std::int64_t bytes, int root) {
  // In a binomial tree the rank at distance d from the root has the children d + 2^k, for 2^k above d.
  const int distance = (comm.rank() - root + comm.size()) % comm.size();
  int children = 0;
  for (std::int64_t step = 1; distance + step < comm.size(); step *= 2)
    children += step > distance ? 1 : 0;
  count(comm, children, children * bytes);
}

void count_gather(const Communicator &comm, std::int64_t bytes, int root) {
  if (comm.rank() != root)
    count(comm, 1, bytes);
}

} // namespace dovetail::traffic
