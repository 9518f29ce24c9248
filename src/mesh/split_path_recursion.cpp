#include "dovetail/mesh/split_path_recursion.hpp"

#include "border_triangulation.hpp"
#include "dovetail/base/error.hpp"
#include "dovetail/geometry/split_path.hpp"
#include "dovetail/mesh/divide_and_conquer.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <chrono>
#include <limits>
#include <numeric>

namespace dovetail {
namespace {

using Vertices = std::vector<LocalIndex>;

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr std::array<Axis, 2> axes{Axis::x, Axis::y};

std::size_t index(LocalIndex i) { return static_cast<std::size_t>(i); }
std::size_t index(Axis axis) { return static_cast<std::size_t>(axis); }
Axis other(Axis axis) { return axis == Axis::x ? Axis::y : Axis::x; }

/// Adds the time it lives to `seconds`, if there is such a thing.
class Stopwatch {
public:
  explicit Stopwatch(double *seconds) : seconds_(seconds) {
    if (seconds_ != nullptr)
      begin_ = Clock::now();
  }
  ~Stopwatch() {
    if (seconds_ != nullptr)
      *seconds_ += std::chrono::duration<double>(Clock::now() - begin_).count();
  }
  Stopwatch(const Stopwatch &) = delete;
  Stopwatch &operator=(const Stopwatch &) = delete;

private:
  using Clock = std::chrono::steady_clock;
  double *seconds_;
  Clock::time_point begin_;
};

/// One axis of a box: its two lines, and the chains of sites whose cells meet the box's sides on them,
/// ascending along the line. Neighbouring sides share the site whose cell holds their corner.
///
///            chain[1] of y                 A cut at m along x leaves
///          +---------------+               chain[0] of x to the low half,
///  chain[0]|       :       |chain[1]       chain[1] of x to the high half,
///    of x  |       : m     |  of x         both chains of y in two parts,
///          +---------------+               and its path to both.
///            chain[0] of y
struct Sides {
  std::array<double, 2> line{-infinite, infinite};
  std::array<Vertices, 2> chain;
};

struct Subproblem {
  std::array<Sides, 2> sides;    ///< by axis
  std::array<Vertices, 2> order; ///< all sites, ascending by x and by y
};

/// The chains of the box that holds everything: lowest and highest row, and the hull between them, collinear
/// sites included.
std::array<Sides, 2> outermost_sides(std::span<const Point> sites, const Vertices &by_y) {
  std::array<Sides, 2> result;
  const auto y = [&](LocalIndex v) { return sites[index(v)].y; };
  for (const LocalIndex v : by_y) {
    if (y(v) == y(by_y.front()))
      result[1].chain[0].push_back(v);
    if (y(v) == y(by_y.back()))
      result[1].chain[1].push_back(v);
  }
  for (std::size_t i = 0; i < by_y.size(); ++i) {
    const bool leftmost = i == 0 || y(by_y[i - 1]) != y(by_y[i]);
    const bool rightmost = i + 1 == by_y.size() || y(by_y[i]) != y(by_y[i + 1]);
    const auto extend = [&](Vertices &chain, Sign inwards) {
      while (chain.size() >= 2 && orientation(sites[index(chain[chain.size() - 2])],
                                              sites[index(chain.back())], sites[index(by_y[i])]) == inwards)
        chain.pop_back();
      chain.push_back(by_y[i]);
    };
    if (leftmost)
      extend(result[0].chain[0], Sign::positive);
    if (rightmost)
      extend(result[0].chain[1], Sign::negative);
  }
  return result;
}

/// The part of an ascending chain up to a site, and the part from it on.
struct Parts {
  Vertices low, high;
};

Parts divide(const Vertices &chain, LocalIndex at) {
  const auto place = std::ranges::find(chain, at);
  assert(place != chain.end());
  return {{chain.begin(), place + 1}, {place, chain.end()}};
}

/// The boundary of a box, counter-clockwise, every vertex as often as it is come to.
void walk_around(const std::array<Sides, 2> &sides, Vertices &walk) {
  walk.clear();
  const auto add = [&](LocalIndex v) {
    if (walk.empty() || walk.back() != v)
      walk.push_back(v);
  };
  std::ranges::for_each(sides[1].chain[0], add);
  std::ranges::for_each(sides[0].chain[1], add);
  std::for_each(sides[1].chain[1].rbegin(), sides[1].chain[1].rend(), add);
  std::for_each(sides[0].chain[0].rbegin(), sides[0].chain[0].rend(), add);
  if (walk.size() > 1 && walk.front() == walk.back())
    walk.pop_back();
}

class Recursion {
public:
  Recursion(std::span<const Point> sites, SplitTrace *trace, Vertices &corners)
      : sites_(sites), trace_(trace), bottom_(sites, corners), mark_(sites.size(), 0) {}

  void solve(Subproblem &&problem, std::size_t depth) {
    const std::size_t border = mark_border(problem);
    const std::size_t interior = problem.order[0].size() - border;
    record(depth, [&](SplitLevel &level) {
      level.subproblems += 1;
      level.bottoms += interior == 0 ? 1 : 0;
      level.largest = std::max(level.largest, static_cast<std::int64_t>(interior));
      level.interior += static_cast<std::int64_t>(interior);
      level.border += static_cast<std::int64_t>(border);
    });
    if (interior == 0) {
      const Stopwatch stopwatch(seconds(&SplitTimes::bottom_s));
      walk_around(problem.sides, walk_);
      return bottom_.solve(walk_);
    }
    const SplitLine line = middle_line(problem, interior);
    const Vertices path = clipped_path(problem, line);
    record(depth, [&](SplitLevel &level) {
      const auto length = static_cast<std::int64_t>(path.size());
      level.path += length;
      level.longest_path = std::max(level.longest_path, length);
    });
    std::array<Subproblem, 2> halves = split(std::move(problem), line, path);
    solve(std::move(halves[0]), depth + 1);
    solve(std::move(halves[1]), depth + 1);
  }

private:
  static constexpr std::uint8_t low = 1, high = 2, on_border = 4;

  double *seconds(double SplitTimes::*phase) const {
    return trace_ != nullptr ? &(trace_->times.*phase) : nullptr;
  }

  template <class Change> void record(std::size_t depth, Change change) {
    if (trace_ == nullptr)
      return;
    if (trace_->levels.size() <= depth)
      trace_->levels.resize(depth + 1);
    change(trace_->levels[depth]);
  }

  Point site(LocalIndex v) const { return sites_[index(v)]; }
  std::uint8_t &mark(LocalIndex v) { return mark_[index(v)]; }

  template <class Visit> static void for_each_in_chains(const std::array<Sides, 2> &sides, Visit visit) {
    for (const Sides &pair : sides)
      for (const Vertices &chain : pair.chain)
        std::ranges::for_each(chain, visit);
  }

  /// Returns how many sites are on the border.
  std::size_t mark_border(const Subproblem &problem) {
    for (const LocalIndex v : problem.order[0])
      mark(v) = 0;
    std::size_t count = 0;
    for_each_in_chains(problem.sides, [&](LocalIndex v) {
      count += mark(v) == 0 ? std::size_t{1} : 0;
      mark(v) = on_border;
    });
    return count;
  }

  /// Through the median interior site, across the longer side of the interior.
  SplitLine middle_line(const Subproblem &problem, std::size_t interior) {
    const auto is_interior = [&](LocalIndex v) { return mark(v) == 0; };
    const auto extent = [&](Axis axis) {
      const Vertices &order = problem.order[index(axis)];
      const LocalIndex first = *std::ranges::find_if(order, is_interior);
      const LocalIndex last = *std::find_if(order.rbegin(), order.rend(), is_interior);
      return across(site(last), axis) - across(site(first), axis);
    };
    const Axis axis = extent(Axis::y) > extent(Axis::x) ? Axis::y : Axis::x;
    std::size_t before = (interior - 1) / 2;
    for (const LocalIndex v : problem.order[index(axis)])
      if (is_interior(v) && before-- == 0)
        return {across(site(v), axis), axis};
    assert(false);
    return {0, axis};
  }

  /// The path of all sites of the subproblem, as far as it is exact: between the corners where the line
  /// leaves the box.
  Vertices clipped_path(const Subproblem &problem, SplitLine line) {
    const Axis upwards = other(line.axis);
    Path path;
    {
      const Stopwatch stopwatch(seconds(&SplitTimes::hull_s));
      ascending_.clear();
      for (const LocalIndex v : problem.order[index(upwards)])
        ascending_.push_back({site(v), v});
      path = split_path_of_ascending(ascending_, line);
    }
    const Stopwatch stopwatch(seconds(&SplitTimes::border_s));
    const auto corner = [&](double position) {
      return line.axis == Axis::x ? Point{line.position, position} : Point{position, line.position};
    };
    std::size_t begin = 0, end = path.size();
    const auto &[bottom, top] = problem.sides[index(upwards)].line;
    if (bottom != -infinite)
      while (begin + 1 < end && nearer(path[begin + 1].point, path[begin].point, corner(bottom)))
        ++begin;
    if (top != infinite)
      while (begin + 1 < end && nearer(path[end - 2].point, path[end - 1].point, corner(top)))
        --end;
    Vertices clipped;
    clipped.reserve(end - begin);
    for (std::size_t i = begin; i < end; ++i)
      clipped.push_back(static_cast<LocalIndex>(path[i].number));
    return clipped;
  }

  std::array<Subproblem, 2> split(Subproblem &&problem, SplitLine line, const Vertices &path) {
    std::array<Subproblem, 2> halves;
    {
      const Stopwatch stopwatch(seconds(&SplitTimes::border_s));
      const std::size_t cut = index(line.axis), uncut = 1 - cut;
      for (std::size_t h = 0; h < 2; ++h) {
        Sides &sides = halves[h].sides[cut];
        sides.line = problem.sides[cut].line;
        sides.line[1 - h] = line.position;
        sides.chain[h] = std::move(problem.sides[cut].chain[h]);
        sides.chain[1 - h] = path;
        halves[h].sides[uncut].line = problem.sides[uncut].line;
      }
      for (std::size_t end = 0; end < 2; ++end) {
        Parts parts = divide(problem.sides[uncut].chain[end], end == 0 ? path.front() : path.back());
        halves[0].sides[uncut].chain[end] = std::move(parts.low);
        halves[1].sides[uncut].chain[end] = std::move(parts.high);
      }
    }
    const Stopwatch stopwatch(seconds(&SplitTimes::split_s));
    for (const LocalIndex v : problem.order[0])
      if (mark(v) == 0)
        mark(v) = across(site(v), line.axis) <= line.position ? low : high;
    for (const LocalIndex v : path)
      mark(v) = low | high;
    for_each_in_chains(halves[0].sides, [&](LocalIndex v) { mark(v) |= low; });
    for_each_in_chains(halves[1].sides, [&](LocalIndex v) { mark(v) |= high; });
    for (const Axis axis : axes) {
      Vertices &order = problem.order[index(axis)];
      std::ranges::copy_if(order, std::back_inserter(halves[1].order[index(axis)]),
                           [&](LocalIndex v) { return (mark(v) & high) != 0; });
      std::erase_if(order, [&](LocalIndex v) { return (mark(v) & low) == 0; });
      halves[0].order[index(axis)] = std::move(order);
    }
    return halves;
  }

  std::span<const Point> sites_;
  SplitTrace *trace_;
  BorderTriangulation bottom_;
  std::vector<std::uint8_t> mark_; ///< of the sites of the subproblem at hand
  std::vector<PathSite> ascending_;
  Vertices walk_;
};

/// Which triangle lies across from each corner, from the corners alone: sides meet in the bucket of their
/// smaller vertex.
Vertices neighbours_of(const Vertices &corners, std::size_t vertices) {
  struct Side {
    LocalIndex larger;
    LocalIndex number;
  };
  const auto ends = [&](std::size_t side) {
    const std::size_t t = side / 3 * 3, i = side - t;
    return std::minmax(corners[t + (i + 1) % 3], corners[t + (i + 2) % 3]);
  };
  std::vector<std::size_t> begin(vertices + 2, 0);
  for (std::size_t side = 0; side < corners.size(); ++side)
    ++begin[index(ends(side).first) + 2];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<Side> sides(corners.size());
  for (std::size_t side = 0; side < corners.size(); ++side) {
    const auto [smaller, larger] = ends(side);
    sides[begin[index(smaller) + 1]++] = {larger, static_cast<LocalIndex>(side)};
  }
  Vertices neighbours(corners.size(), none);
  for (std::size_t v = 0; v < vertices; ++v) {
    const std::span bucket(sides.data() + begin[v], begin[v + 1] - begin[v]);
    std::ranges::sort(bucket, {}, &Side::larger);
    for (std::size_t i = 0; i + 1 < bucket.size(); ++i)
      if (bucket[i].larger == bucket[i + 1].larger) {
        neighbours[index(bucket[i].number)] = bucket[i + 1].number / 3;
        neighbours[index(bucket[i + 1].number)] = bucket[i].number / 3;
        ++i;
      }
  }
  return neighbours;
}

} // namespace

Triangulation delaunay_by_split_paths(std::span<const Point> sites, SplitTrace *trace) {
  if (sites.size() > most_delaunay_sites)
    throw Error({ErrorKind::resource, "triangulation", "",
                 "a slab has more sites than 32-bit indices can number", "use more slabs"});
  Triangulation mesh;
  if (sites.size() < 3)
    return mesh;
  Subproblem whole;
  {
    const Stopwatch stopwatch(trace != nullptr ? &trace->times.sort_s : nullptr);
    for (const Axis axis : axes) {
      Vertices &order = whole.order[index(axis)];
      order.resize(sites.size());
      std::iota(order.begin(), order.end(), 0);
      std::ranges::sort(order, TotalOrder{axis}, [&](LocalIndex v) { return sites[index(v)]; });
    }
  }
  whole.sides = outermost_sides(sites, whole.order[1]);
  Recursion(sites, trace, mesh.corners).solve(std::move(whole), 0);
  const Stopwatch stopwatch(trace != nullptr ? &trace->times.bottom_s : nullptr);
  mesh.neighbours = neighbours_of(mesh.corners, sites.size());
  return mesh;
}

} // namespace dovetail
