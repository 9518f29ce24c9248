/// Where to cut sorted points that are spread over ranks. Collective.
#pragma once

#include "dovetail/base/point_table.hpp"
#include "dovetail/comm/communicator.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace dovetail {

/// Every rank has `points` sorted and without equals, but other ranks may have equal ones. For each of the
/// `targets` (ascending, alike on all ranks) finds a position in the total order with exactly so many points
/// before it on all ranks together, or as many as equal points allow without exceeding it; gives how many of
/// this rank's points are before each.
///
/// Bisection of the 128-bit space of positions, all targets at once. At most 128 rounds, about log2(points)
/// plus the spread of exponents in practice; O(log(points)) a target and rank in all.
std::vector<std::int64_t> cut_positions(const Communicator &comm, std::span<const Point> points, Axis axis,
                                        std::span<const GlobalIndex> targets);

/// Sends the first send_counts[0] of the sorted points to rank 0, the next to rank 1, and so on, column after
/// column through one buffer, and merges what arrives: the table is sorted again.
void redistribute(const Communicator &comm, PointTable &table, Axis axis,
                  std::span<const std::int64_t> send_counts);

} // namespace dovetail
