/// What a run of triangulate will take, found before it starts.
#pragma once

#include "dovetail/comm/communicator.hpp"
#include "dovetail/distributed/forecast.hpp"
#include "dovetail/io/point_stream.hpp"

#include <cstdint>
#include <string>

namespace dovetail::cli {

/// What the user allows.
struct Room {
  std::int64_t memory_bytes = 0; ///< --memory, of a rank; 0: default_memory_of_rank
  std::string scratch;           ///< --scratch; empty: the folder of the output
  bool on_disk = false;          ///< --on-disk
};

struct Plan {
  Forecast forecast;
  GlobalIndex points = 0;        ///< about, if the input is text
  std::int64_t memory_bytes = 0; ///< that a rank may have in all
  std::int64_t usable_bytes = 0; ///< of that, what is left for data
  std::string scratch;           ///< the folder
};

/// Collective; the same on all ranks. `output`: a mesh file or "none"; `streams`: it is filled slab by slab.
/// Looks at a sample of the points only where the length of paths may matter, or `always`.
Plan plan_run(const Communicator &comm, const PointFiles &files, const SlabOptions &slabs, const Room &room,
              const std::string &output, bool streams, bool always);

/// Collective. Refuses (Error, resource) what cannot fit into memory or onto the disk, and says what would.
void require_room(const Communicator &comm, const Plan &plan, const std::string &output, bool streams);

/// Prints the plan, for people.
void print_plan(const Plan &plan, int ranks, bool writes);

/// "4GiB", "512 MiB", "1.5G", "1000000": bytes. Letters are powers of 1024. Throws std::invalid_argument with
/// a reason.
std::int64_t bytes_from_text(const std::string &text);

} // namespace dovetail::cli
