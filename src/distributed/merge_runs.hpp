/// Merging what sorted ranks have sent: runs that are sorted, one after another. Local.
#pragma once

#include "dovetail/base/types.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace dovetail {

/// How to merge runs of the given lengths that lie one after another in `points`, each sorted by the total
/// order: the run from which each point of the merge comes. Empty if the points are sorted as they lie.
/// A tree of winners: O(log(runs)) a point, without branches that cannot be foreseen.
std::vector<std::uint32_t> merge_order(std::span<const Point> points, std::span<const std::int64_t> lengths,
                                       Axis axis);

/// One column of the merge. With the order known, every run is read from front to back.
template <class Value>
void merge_column(std::span<const Value> column, std::span<const std::int64_t> lengths,
                  std::span<const std::uint32_t> order, std::span<Value> out) {
  if (order.empty()) {
    std::copy(column.begin(), column.end(), out.begin());
    return;
  }
  std::vector<std::int64_t> next(lengths.size(), 0);
  std::partial_sum(lengths.begin(), lengths.end() - 1, next.begin() + 1);
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = column[static_cast<std::size_t>(next[order[i]]++)];
}

} // namespace dovetail
