/// How much memory a rank may count on.
#pragma once

#include "dovetail/comm/communicator.hpp"

#include <cstdint>
#include <string>

namespace dovetail {

/// Local. The memory of this machine, or what a control group (cgroup, version 1 or 2) allows this process of
/// it, whichever is less; 0 where the system does not tell. `root`: the folder that has proc and sys.
std::int64_t node_memory_bytes(const std::string &root = "");

/// Collective. 70 % of that, shared equally among the ranks of `comm` on the same node; the least of all
/// ranks, so that it is the same on all of them. 0 where the system does not tell.
std::int64_t default_memory_of_rank(const Communicator &comm);

} // namespace dovetail
