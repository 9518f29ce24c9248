#include "slab_borders.hpp"

#include "dovetail/base/huge_pages.hpp"
#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/exchange.hpp"
#include "merge_runs.hpp"
#include "sort_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <memory>
#include <numeric>

namespace dovetail {
namespace {

/// `across` in the upper, `along` in the lower half: the total order as one integer.
__extension__ using Position = unsigned __int128;

Position position_of(Point p, Axis axis) {
  return (static_cast<Position>(ordered_bits(across(p, axis))) << 64) | ordered_bits(along(p, axis));
}

/// The position sought for one target is in [low, high); this rank's points before it number at least
/// low_count and at most high_count.
struct Bracket {
  GlobalIndex target;
  Position low = 0;
  Position high = 0;
  std::int64_t low_count = 0;
  std::int64_t high_count = 0;
  bool found = false;
};

} // namespace

std::vector<std::int64_t> cut_positions(const Communicator &comm, std::span<const Point> points, Axis axis,
                                        std::span<const GlobalIndex> targets) {
  const std::int64_t count = std::ssize(points);
  const GlobalIndex total = all_reduce_sum(comm, count);
  const auto first = points.empty() ? ~std::uint64_t{0} : ordered_bits(across(points.front(), axis));
  const auto last = points.empty() ? std::uint64_t{0} : ordered_bits(across(points.back(), axis));
  // Nothing is below `lowest` and, of finite coordinates, nothing at or above `beyond`.
  const Position lowest = static_cast<Position>(all_reduce_min(comm, first)) << 64;
  const Position beyond = static_cast<Position>(all_reduce_max(comm, last) + 1) << 64;

  std::vector<Bracket> brackets;
  for (const GlobalIndex target : targets)
    brackets.push_back(
        {target, lowest, beyond, target >= total ? count : 0, count, target <= 0 || target >= total});

  const auto is_open = [](const Bracket &b) { return !b.found && b.high - b.low > 1; };
  const auto middle = [](const Bracket &b) { return b.low + (b.high - b.low) / 2; };
  const auto count_before = [&](const Bracket &b) {
    const auto at = std::lower_bound(points.begin() + b.low_count, points.begin() + b.high_count, middle(b),
                                     [&](Point p, Position m) { return position_of(p, axis) < m; });
    return static_cast<std::int64_t>(at - points.begin());
  };
  for (;;) {
    std::vector<std::int64_t> own;
    for (const Bracket &b : brackets)
      if (is_open(b))
        own.push_back(count_before(b));
    if (own.empty())
      break;
    const std::vector<std::int64_t> all = all_reduce_sum(comm, own);
    std::size_t next = 0;
    for (Bracket &b : brackets) {
      if (!is_open(b))
        continue;
      const bool enough = all[next] > b.target;
      (enough ? b.high : b.low) = middle(b);
      (enough ? b.high_count : b.low_count) = own[next];
      b.found = all[next] == b.target;
      ++next;
    }
  }
  std::vector<std::int64_t> cuts;
  std::ranges::transform(brackets, std::back_inserter(cuts), &Bracket::low_count);
  return cuts;
}

void redistribute(const Communicator &comm, PointTable &table, Axis axis,
                  std::span<const std::int64_t> send_counts) {
  const auto own = static_cast<std::size_t>(comm.rank());
  const std::vector<std::int64_t> receive_counts = exchange_counts(comm, send_counts);
  const std::int64_t sent = std::reduce(send_counts.begin(), send_counts.end());
  const std::int64_t received = std::reduce(receive_counts.begin(), receive_counts.end());
  if (!any_of_ranks(comm, sent != send_counts[own] || received != receive_counts[own]))
    return;

  const auto size = static_cast<std::size_t>(received);
  const auto purpose = [&] { return fmt::format("{} points that belong to its slabs", size); };
  const auto buffer = collectively(comm, purpose, [&] {
    if (size > table.points.size()) {
      reserve_huge(table.points, size);
      reserve_huge(table.input_index, size);
      for (Attribute &attribute : table.attributes)
        reserve_huge(attribute.values, size);
    }
    return make_huge_for_overwrite<std::byte>(size * sizeof(Point));
  });
  std::vector<MergeRound> rounds;
  const auto send_column = [&]<class Value>(std::vector<Value> &column) {
    static_assert(sizeof(Value) <= sizeof(Point));
    const std::span arrived(reinterpret_cast<Value *>(buffer.get()), size);
    exchange_into<Value>(comm, column, send_counts, arrived, receive_counts);
    column.resize(size);
    return arrived;
  };
  const auto send_and_merge = [&]<class Value>(std::vector<Value> &column) {
    const std::span<Value> arrived = send_column(column);
    merge_column<Value>(rounds, arrived, column);
  };
  const std::span<Point> points = send_column(table.points);
  rounds =
      collectively(comm, purpose, [&] { return merge_points(points, receive_counts, axis, table.points); });
  send_and_merge(table.input_index);
  for (Attribute &attribute : table.attributes)
    send_and_merge(attribute.values);
}

} // namespace dovetail
