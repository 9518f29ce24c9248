#include "dovetail/mesh/split_path_recursion.hpp"

#include "border_triangulation.hpp"
#include "box_splitting.hpp"
#include "dovetail/base/error.hpp"
#include "dovetail/base/huge_pages.hpp"
#include "dovetail/mesh/divide_and_conquer.hpp"
#include "presorted_sites.hpp"

#include <algorithm>
#include <chrono>
#include <ranges>
#include <utility>

namespace dovetail {
namespace {

/// So few interior sites are triangulated together with their border.
constexpr std::size_t few_sites = 4;

std::size_t index(LocalIndex i) { return static_cast<std::size_t>(i); }

/// What the work gives; its time is added to the trace.
template <class Work> auto timed(SplitTrace *trace, double SplitTimes::*part, Work work) {
  using Clock = std::chrono::steady_clock;
  struct Stopwatch {
    SplitTrace *trace;
    double SplitTimes::*part;
    Clock::time_point begin;
    ~Stopwatch() {
      if (trace != nullptr)
        trace->times.*part += std::chrono::duration<double>(Clock::now() - begin).count();
    }
  };
  const Stopwatch stopwatch{trace, part, trace != nullptr ? Clock::now() : Clock::time_point()};
  return work();
}

/// Sites on the border, each as often as the way around comes to it.
std::size_t border(const Box &box) {
  std::size_t count = 0;
  for (const auto &pair : box.sides)
    for (const Side &side : pair) // its last site is the first of the next side
      count += side.chain.size() - 1;
  return count;
}

class Recursion {
public:
  Recursion(PresortedSites &&sites, SplitTrace *trace, Triangulation &mesh)
      : boxes_(std::move(sites)), bottom_(boxes_.points(), mesh), trace_(trace) {}

  void solve() {
    solve(timed(trace_, &SplitTimes::hull_s, [&] { return boxes_.whole(); }), 0);
    bottom_.finish();
  }

private:
  void solve(const Box &box, std::size_t depth) {
    const bool is_bottom = box.interior() == 0 || (box.interior() <= few_sites &&
                                                   border(box) <= BorderTriangulation::longest_around_sites);
    record(depth, [&](SplitLevel &level) { add(box, is_bottom, level); });
    if (is_bottom)
      return timed(trace_, &SplitTimes::bottom_s,
                   [&] { bottom_.solve(boxes_.walk_around(box), boxes_.interior(box, Axis::x)); });
    const SplitLine line = boxes_.middle(box);
    const Ends ends = timed(trace_, &SplitTimes::border_s, [&] { return boxes_.ends(box, line); });
    const Chain path = timed(trace_, &SplitTimes::hull_s, [&] { return boxes_.path(box, line, ends); });
    const auto [low, high] =
        timed(trace_, &SplitTimes::split_s, [&] { return boxes_.divide(box, line, ends, path); });
    record(depth, [&](SplitLevel &level) { add(path, level); });
    solve(low, depth + 1);
    solve(high, depth + 1);
    boxes_.drop(path);
  }

  template <class Change> void record(std::size_t depth, Change change) {
    if (trace_ == nullptr)
      return;
    if (trace_->levels.size() <= depth)
      trace_->levels.resize(depth + 1);
    change(trace_->levels[depth]);
  }

  static void add(const Box &box, bool is_bottom, SplitLevel &level) {
    const auto interior = static_cast<std::int64_t>(box.interior());
    level.subproblems += 1;
    level.bottoms += is_bottom ? 1 : 0;
    level.bottom_interior += is_bottom ? interior : 0;
    level.largest = std::max(level.largest, interior);
    level.interior += interior;
    level.border += static_cast<std::int64_t>(border(box));
  }

  static void add(Chain path, SplitLevel &level) {
    const auto length = static_cast<std::int64_t>(path.size());
    level.path += length;
    level.longest_path = std::max(level.longest_path, length);
  }

  BoxSplitting boxes_;
  BorderTriangulation bottom_;
  SplitTrace *trace_;
};

} // namespace

Triangulation delaunay_by_split_paths(std::span<const Point> sites, SplitTrace *trace) {
  if (sites.size() > most_delaunay_sites)
    throw Error({ErrorKind::resource, "triangulation", "",
                 "a slab has more sites than 32-bit indices can number", "use more slabs"});
  Triangulation mesh;
  if (sites.size() < 3)
    return mesh;
  reserve_huge(mesh.corners, 6 * sites.size());
  reserve_huge(mesh.neighbours, 6 * sites.size());
  PresortedSites presorted = timed(trace, &SplitTimes::sort_s, [&] { return presort(sites); });
  const std::vector<LocalIndex> original = std::move(presorted.original);
  Recursion(std::move(presorted), trace, mesh).solve();
  for (LocalIndex &corner : mesh.corners)
    corner = original[index(corner)];
  return mesh;
}

} // namespace dovetail
