#include "dovetail/geometry/split_path.hpp"

#include <array>

namespace dovetail {
namespace {

/// A slab's sites as seen from the line: number 0 is the nearest, or one of them.
template <Axis axis> class Outward {
public:
  Outward(std::span<const Point> sites, GlobalIndex first_number, SplitLine line, bool line_is_after)
      : sites_(sites), first_number_(first_number), line_(line.position), line_is_after_(line_is_after) {}

  std::span<const Point> in_order() const { return sites_; }
  std::size_t size() const { return sites_.size(); }
  std::size_t index(std::size_t k) const { return line_is_after_ ? sites_.size() - 1 - k : k; }
  double position(std::size_t k) const { return along(sites_[index(k)], axis); }
  double distance(std::size_t k) const { return std::fabs(across(sites_[index(k)], axis) - line_); }
  PathSite numbered(std::size_t k) const {
    return {sites_[index(k)], first_number_ + static_cast<GlobalIndex>(index(k))};
  }

private:
  std::span<const Point> sites_;
  GlobalIndex first_number_;
  double line_;
  bool line_is_after_;
};

template <Axis axis>
std::vector<PathSite> numbered_range(const Outward<axis> &sites, std::size_t begin, std::size_t end) {
  std::vector<PathSite> result;
  result.reserve(end - begin);
  for (std::size_t k = begin; k < end; ++k)
    result.push_back(sites.numbered(k));
  return result;
}

struct Extremes {
  std::size_t lowest;
  std::size_t highest;
};

/// Of sites in any order; not empty. Four at a time, and only blocks that hold a new extreme are read again.
template <Axis axis> Extremes extremes(std::span<const Point> sites) {
  constexpr std::size_t block = 256;
  Extremes result{0, 0};
  double low = along(sites.front(), axis), high = low;
  for (std::size_t begin = 0; begin < sites.size(); begin += block) {
    const std::size_t end = std::min(begin + block, sites.size());
    std::array<double, 4> lows = {low, low, low, low}, highs = {high, high, high, high};
    std::size_t i = begin;
    for (; i + 4 <= end; i += 4)
      for (std::size_t lane = 0; lane < 4; ++lane) {
        lows[lane] = std::min(lows[lane], along(sites[i + lane], axis));
        highs[lane] = std::max(highs[lane], along(sites[i + lane], axis));
      }
    const bool none_new = std::ranges::min(lows) == low && std::ranges::max(highs) == high && i == end;
    if (none_new)
      continue;
    for (i = begin; i < end; ++i) {
      const double position = along(sites[i], axis);
      if (position < low) {
        low = position;
        result.lowest = i;
      } else if (position > high) {
        high = position;
        result.highest = i;
      }
    }
  }
  return result;
}

/// The first of the sites begin .. end - 1 that is farther from the line than `reach`.
template <Axis axis>
std::size_t first_beyond(const Outward<axis> &sites, std::size_t begin, std::size_t end, double reach) {
  while (begin < end) {
    const std::size_t k = begin + (end - begin) / 2;
    if (sites.distance(k) > reach)
      end = k;
    else
      begin = k + 1;
  }
  return begin;
}

/// Those of the sites begin .. end - 1 that the filter lets through. Nearly all lie where nothing so far from
/// the line is let through: blocks find those in a short loop without branches.
template <Axis axis>
std::vector<PathSite> let_through(const Outward<axis> &sites, std::size_t begin, std::size_t end,
                                  const PathFilter &filter) {
  std::vector<PathSite> passed;
  if (begin == end)
    return passed;
  const PathFilter::Interval quiet = filter.quiet_interval(sites.distance(begin));
  constexpr std::uint32_t block = 1024;
  std::array<std::uint32_t, block> promising;
  for (; begin < end; begin += block) {
    const auto count = static_cast<std::uint32_t>(std::min<std::size_t>(block, end - begin));
    std::size_t found = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      const double position = sites.position(begin + i);
      promising[found] = i;
      found +=
          static_cast<std::size_t>(position <= quiet.low) | static_cast<std::size_t>(position >= quiet.high);
    }
    for (std::size_t i = 0; i < found; ++i) {
      const PathSite site = sites.numbered(begin + promising[i]);
      if (filter.lets_through(site.point))
        passed.push_back(site);
    }
  }
  return passed;
}

/// A strip of sites next to the line, with the lowest and the highest of all, makes an approximate path; the
/// others follow outwards, in batches as large as all before them, and of each only what the path so far lets
/// through. Since the path spans all sites, those beyond its reach need not be looked at.
template <Axis axis> Path hull_outward(const Outward<axis> &sites, SplitLine line) {
  const std::size_t n = sites.size();
  std::size_t seen = std::min(n, static_cast<std::size_t>(64 + 4 * std::sqrt(static_cast<double>(n))));
  std::vector<PathSite> nearby = numbered_range(sites, 0, seen);
  if (seen < n) {
    const Extremes ends = extremes<axis>(sites.in_order());
    for (const std::size_t i : {ends.lowest, ends.highest})
      nearby.push_back(sites.numbered(sites.index(i))); // index() is its own inverse
  }
  Path path = split_path(std::move(nearby), line);
  std::size_t growth = 2;
  while (seen < n) {
    const PathFilter filter(path, line);
    const std::size_t end = first_beyond(sites, seen, n, filter.reach());
    const std::size_t batch_end = std::min(end, growth * seen);
    std::vector<PathSite> passed = let_through(sites, seen, batch_end, filter);
    // Where most sites are on the path, hulls of hulls are work in vain: larger steps.
    growth = passed.size() > (batch_end - seen) / 2 ? 8 : 2;
    path = hull_of_both(path, split_path(std::move(passed), line), line);
    seen = batch_end == end ? n : batch_end;
  }
  return path;
}

template <Axis axis>
Path own_hull_on(std::span<const Point> sites, GlobalIndex first_number, SplitLine line) {
  const bool line_is_after = across(sites.back(), axis) <= line.position;
  const bool line_is_before = across(sites.front(), axis) >= line.position;
  const Outward<axis> outward(sites, first_number, line, line_is_after);
  return line_is_after || line_is_before ? hull_outward(outward, line)
                                         : split_path(numbered_range(outward, 0, sites.size()), line);
}

} // namespace

Path own_hull(std::span<const Point> sites, GlobalIndex first_number, SplitLine line) {
  if (sites.empty())
    return {};
  return line.axis == Axis::x ? own_hull_on<Axis::x>(sites, first_number, line)
                              : own_hull_on<Axis::y>(sites, first_number, line);
}

} // namespace dovetail
