#include "split_trace.hpp"

#include "text.hpp"

#include <fmt/core.h>

#include <array>
#include <utility>

namespace dovetail::cli {
namespace {

constexpr std::array<std::pair<const char *, double SplitTimes::*>, 5> parts{
    {{"sort", &SplitTimes::sort_s},
     {"hull", &SplitTimes::hull_s},
     {"border", &SplitTimes::border_s},
     {"split", &SplitTimes::split_s},
     {"bottom", &SplitTimes::bottom_s}}};

} // namespace

const char *kernel_name(Kernel kernel) { return kernel == Kernel::merge ? "merge" : "split-path"; }

Report split_trace_as_json(const SplitTraceSummary &trace) {
  Report levels = Report::array();
  for (const SplitLevel &level : trace.all.levels)
    levels.push_back({{"subproblems", level.subproblems},
                      {"bottoms", level.bottoms},
                      {"largest", level.largest},
                      {"bucketing", level.bucketing()},
                      {"interior", level.interior},
                      {"bottom_interior", level.bottom_interior},
                      {"border", level.border},
                      {"path", level.path},
                      {"longest_path", level.longest_path}});
  Report times = Report::array();
  for (const auto &[name, part] : parts)
    times.push_back({{"name", name}, {"sum_s", trace.all.times.*part}, {"max_s", trace.slowest.*part}});
  return {{"levels", std::move(levels)}, {"times", std::move(times)}};
}

void print_split_trace(const SplitTraceSummary &trace, GlobalIndex sites) {
  constexpr const char *row = "{:>5} {:>12} {:>12} {:>12} {:>12} {:>10} {:>12} {:>12} {:>9}\n";
  fmt::print("\n");
  fmt::print(row, "level", "subproblems", "bottoms", "interior", "largest", "border", "bucketing", "path",
             "longest");
  for (std::size_t depth = 0; depth < trace.all.levels.size(); ++depth) {
    const SplitLevel &level = trace.all.levels[depth];
    fmt::print(row, depth, with_separators(level.subproblems), with_separators(level.bottoms),
               with_separators(level.interior), with_separators(level.largest), with_separators(level.border),
               fmt::format("{:.2f}", level.bucketing()), with_separators(level.path),
               with_separators(level.longest_path));
  }
  fmt::print("\n{:>7} {:>10} {:>12} {:>14}\n", "part", "time", "largest rank", "ns per site");
  for (const auto &[name, part] : parts)
    fmt::print("{:>7} {:>10} {:>12} {:>14.1f}\n", name, duration_text(trace.all.times.*part),
               duration_text(trace.slowest.*part),
               sites > 0 ? 1e9 * (trace.all.times.*part) / static_cast<double>(sites) : 0.0);
}

} // namespace dovetail::cli
