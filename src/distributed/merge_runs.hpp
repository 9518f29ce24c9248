/// Merging what sorted ranks have sent: runs that are sorted, one after another. Local.
#pragma once

#include "dovetail/base/types.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace dovetail {

/// One round of merging neighbouring runs in pairs: [begins[2p], begins[2p + 1]) with
/// [begins[2p + 1], begins[2p + 2]). A last run without a partner has an empty one.
struct MergeRound {
  std::vector<std::size_t> begins;      ///< an odd number: one of every run, and the end
  std::vector<std::uint8_t> from_right; ///< for each place of the result, whether the right run fills it
};

/// Merges runs of the given lengths that lie one after another in `arrived`, each sorted by the total order,
/// into `merged`; the former contents of both are lost. What was decided is returned, to do the same with
/// other columns; empty if the points are sorted as they lie.
/// Cost: log2(runs) rounds, each with neither a branch to be mispredicted nor a jump through memory, and a
/// byte a point for each.
std::vector<MergeRound> merge_points(std::span<Point> arrived, std::span<const std::int64_t> lengths,
                                     Axis axis, std::span<Point> merged);

/// One more column of the same merge.
template <class Value>
void merge_column(std::span<const MergeRound> rounds, std::span<Value> arrived, std::span<Value> merged) {
  std::span<Value> from = arrived, to = merged;
  for (const MergeRound &round : rounds) {
    for (std::size_t p = 0; p + 2 < round.begins.size(); p += 2) {
      std::size_t left = round.begins[p], right = round.begins[p + 1];
      for (std::size_t place = left, end = round.begins[p + 2]; place < end; ++place) {
        const std::size_t taken = round.from_right[place];
        to[place] = from[left + ((right - left) & (0 - taken))];
        right += taken;
        left += 1 - taken;
      }
    }
    std::swap(from, to);
  }
  if (from.data() != merged.data())
    std::copy(from.begin(), from.end(), merged.begin());
}

} // namespace dovetail
