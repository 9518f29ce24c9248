#include "dovetail/distributed/kernel.hpp"

#include "dovetail/comm/collectives.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <vector>

namespace dovetail {
namespace {

constexpr std::array added{&SplitLevel::subproblems,     &SplitLevel::bottoms, &SplitLevel::interior,
                           &SplitLevel::bottom_interior, &SplitLevel::border,  &SplitLevel::path};
constexpr std::array largest{&SplitLevel::largest, &SplitLevel::longest_path};
constexpr std::array times{&SplitTimes::sort_s, &SplitTimes::hull_s, &SplitTimes::border_s,
                           &SplitTimes::split_s, &SplitTimes::bottom_s};

} // namespace

SplitTraceSummary summarise(const Communicator &comm, const SplitTrace &trace) {
  SplitTraceSummary summary;
  auto &levels = summary.all.levels = trace.levels;
  levels.resize(all_reduce_max(comm, levels.size()));
  const auto reduce = [&](std::int64_t SplitLevel::*figure, auto &&operation) {
    std::vector<std::int64_t> values;
    std::ranges::transform(levels, std::back_inserter(values), figure);
    values = operation(values);
    for (std::size_t depth = 0; depth < levels.size(); ++depth)
      levels[depth].*figure = values[depth];
  };
  for (const auto figure : added)
    reduce(figure, [&](const auto &values) { return all_reduce_sum(comm, values); });
  for (const auto figure : largest)
    reduce(figure, [&](const auto &values) { return all_reduce_max(comm, values); });
  for (const auto time : times) {
    summary.all.times.*time = all_reduce_sum(comm, trace.times.*time);
    summary.slowest.*time = all_reduce_max(comm, trace.times.*time);
  }
  return summary;
}

} // namespace dovetail
