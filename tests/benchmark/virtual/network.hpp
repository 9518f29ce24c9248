/// What a message takes on a modelled network. A stated model, not a measurement: every rank has a link of
/// its own into a network that is never the bottleneck itself.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

namespace dovetail::virtual_ranks {

/// The defaults are those of a common cluster: InfiniBand at 200 Gbit/s, shared by two dozen ranks of a node.
struct Network {
  double latency_s = 2e-6;       ///< from the sender's network to the receiver's
  double overhead_s = 0.5e-6;    ///< of the processor, for each message sent or received
  double bytes_per_second = 1e9; ///< of a rank's link, each way
  double transfer(std::int64_t bytes) const { return static_cast<double>(bytes) / bytes_per_second; }
  double message(std::int64_t bytes) const { return latency_s + 2 * overhead_s + transfer(bytes); }

  // Collectives, from the last arrival on.
  static int depth(int ranks) { return static_cast<int>(std::bit_width(static_cast<unsigned>(ranks - 1))); }
  /// Recursive doubling; scans take as long.
  double all_reduce(int ranks, std::int64_t bytes) const { return depth(ranks) * message(bytes); }
  /// Recursive doubling: pieces double as well.
  double all_gather(int ranks, std::int64_t bytes_each) const {
    return depth(ranks) * message(0) + transfer((ranks - 1) * bytes_each);
  }
  /// A binomial tree, or for long data scattering (by a tree) and gathering (round the ranks).
  double broadcast(int ranks, std::int64_t bytes) const {
    if (ranks == 1)
      return 0;
    const double tree = depth(ranks) * message(bytes);
    const double pieces = (depth(ranks) + ranks - 1) * message(0) + 2 * transfer(bytes);
    return std::min(tree, pieces);
  }
  /// One message from every rank to the root, which takes them one after another.
  double gather(int ranks, std::int64_t bytes_of_others) const {
    return ranks == 1 ? 0 : latency_s + ranks * overhead_s + transfer(bytes_of_others);
  }
  /// One message from every rank to every other.
  double all_to_all(int ranks, std::int64_t bytes_each) const {
    return ranks == 1 ? 0 : latency_s + (ranks - 1) * 2 * overhead_s + transfer((ranks - 1) * bytes_each);
  }
};

} // namespace dovetail::virtual_ranks
