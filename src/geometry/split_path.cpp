#include "dovetail/geometry/split_path.hpp"

#include <iterator>

namespace dovetail {
namespace {

auto ascending(Axis axis) {
  return [axis](const PathSite &a, const PathSite &b) { return along(a.point, axis) < along(b.point, axis); };
}

} // namespace

Path split_path(std::vector<PathSite> sites, SplitLine line) {
  if (!std::ranges::is_sorted(sites, ascending(line.axis)))
    std::ranges::sort(sites, ascending(line.axis));
  return split_path_of_ascending(sites, line);
}

Path split_path_of_ascending(std::span<const PathSite> sites, SplitLine line) {
  Path hull;
  for (std::size_t i = 0; i < sites.size();) {
    PathSite nearest = sites[i++];
    const double position = along(nearest.point, line.axis);
    for (; i < sites.size() && along(sites[i].point, line.axis) == position; ++i)
      if (nearer(sites[i].point, nearest.point, line))
        nearest = sites[i];
    while (hull.size() >= 2 &&
           hull_turn(hull[hull.size() - 2].point, hull.back().point, nearest.point, line) != Sign::positive)
      hull.pop_back();
    hull.push_back(nearest);
  }
  return hull;
}

Path hull_of_both(std::span<const PathSite> a, std::span<const PathSite> b, SplitLine line) {
  std::vector<PathSite> both;
  both.reserve(a.size() + b.size());
  std::ranges::merge(a, b, std::back_inserter(both), ascending(line.axis));
  return split_path_of_ascending(both, line);
}

} // namespace dovetail
