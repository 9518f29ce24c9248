/// Paths on their way from rank to rank. Short ones travel as Boost.Serialization types through Boost.MPI;
/// its archives and messages count bytes in 32 bits and fail somewhere after 2^31 of them (about 90 million
/// sites), so long ones go in bulk. Room for them is made before, and agreed on.
#pragma once

#include "dovetail/comm/communicator.hpp"
#include "dovetail/geometry/split_path.hpp"

namespace dovetail {

/// Collective. The root's path on every rank.
void broadcast_path(const Communicator &comm, Path &path, int root);

/// Collective. The chains of all ranks on the root, one after the other; elsewhere nothing.
Path gather_chains(const Communicator &comm, const Path &chain, int root);

} // namespace dovetail
