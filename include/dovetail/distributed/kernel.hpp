/// Which kernel makes a slab's triangles, and what the slower one tells.
#pragma once

#include "dovetail/comm/communicator.hpp"
#include "dovetail/mesh/split_path_recursion.hpp"

#include <cstdint>

namespace dovetail {

/// All kernels make the same mesh, with the triangles of a slab in another order.
enum class Kernel : std::uint8_t {
  merge,     ///< mesh/divide_and_conquer.hpp, the fast one
  split_path ///< mesh/split_path_recursion.hpp
};

struct KernelChoice {
  Kernel kernel = Kernel::merge;
  SplitTrace *trace = nullptr; ///< all own slabs are added to it; the kernel `merge` leaves none
};

/// The traces of several ranks.
struct SplitTraceSummary {
  SplitTrace all;     ///< added up: counts of a level of all slabs, their largest and longest, processor time
  SplitTimes slowest; ///< of each kind the most time on a rank
};

/// Collective; the same on all ranks.
SplitTraceSummary summarise(const Communicator &comm, const SplitTrace &trace);

} // namespace dovetail
