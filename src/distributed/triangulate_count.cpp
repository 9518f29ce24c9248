#include "dovetail/distributed/triangulate_region.hpp"
#include "dovetail/geometry/predicates.hpp"

#include <algorithm>
#include <iterator>

namespace dovetail {
namespace {

using Numbers = std::vector<GlobalIndex>;

Numbers numbers_of(const Path &path) {
  Numbers numbers;
  for (const PathSite &site : path)
    numbers.push_back(site.number);
  return numbers;
}

/// Own and path sites, each once, by (along, across).
Path sites_by_row(std::span<const Point> own_sites, GlobalIndex first_site, const Path &left,
                  const Path &right, Axis axis) {
  Path sites;
  for (const Point &point : own_sites)
    sites.push_back({point, first_site + static_cast<GlobalIndex>(sites.size())});
  sites.insert(sites.end(), left.begin(), left.end());
  sites.insert(sites.end(), right.begin(), right.end());
  std::ranges::sort(sites, [&](const PathSite &a, const PathSite &b) {
    return std::pair(along(a.point, axis), across(a.point, axis)) <
           std::pair(along(b.point, axis), across(b.point, axis));
  });
  const auto same = [](const PathSite &a, const PathSite &b) { return a.number == b.number; };
  sites.erase(std::unique(sites.begin(), sites.end(), same), sites.end());
  return sites;
}

bool all_collinear(const Path &sites) {
  return std::ranges::all_of(sites, [&](const PathSite &site) {
    return orientation(sites.front().point, sites.back().point, site.point) == Sign::zero;
  });
}

/// The convex hull's chain at lower (or higher) across, upwards from the lowest to the highest row, collinear
/// sites included.
Path hull_chain(const Path &by_row, Axis axis, bool lower_side) {
  const Sign outwards = (axis == Axis::x) == lower_side ? Sign::positive : Sign::negative;
  Path chain;
  for (std::size_t i = 0; i < by_row.size(); ++i) {
    const auto row = [&](std::size_t j) { return along(by_row[j].point, axis); };
    const bool extreme =
        lower_side ? i == 0 || row(i - 1) < row(i) : i + 1 == by_row.size() || row(i) < row(i + 1);
    if (!extreme)
      continue;
    while (chain.size() >= 2 &&
           orientation(chain[chain.size() - 2].point, chain.back().point, by_row[i].point) == outwards)
      chain.pop_back();
    chain.push_back(by_row[i]);
  }
  return chain;
}

/// The sites of the row through `from` and `to` behind `from`, up to `to`.
void append_row(Numbers &chain, const Path &by_row, Axis axis, const PathSite &from, const PathSite &to) {
  for (const PathSite &site : by_row)
    if (along(site.point, axis) == along(from.point, axis) &&
        across(site.point, axis) > across(from.point, axis) &&
        across(site.point, axis) <= across(to.point, axis))
      chain.push_back(site.number);
}

} // namespace

GlobalIndex triangles_between(std::span<const Point> own_sites, GlobalIndex first_site, const Path &left,
                              const Path &right, Axis axis) {
  const Path by_row = sites_by_row(own_sites, first_site, left, right, axis);
  if (by_row.size() < 3 || all_collinear(by_row))
    return 0;
  const Path left_core = left.empty() ? hull_chain(by_row, axis, true) : left;
  const Path right_core = right.empty() ? hull_chain(by_row, axis, false) : right;
  Numbers right_chain = numbers_of(right_core), left_chain = numbers_of(left_core);
  append_row(left_chain, by_row, axis, left_core.front(), right_core.front());
  append_row(left_chain, by_row, axis, left_core.back(), right_core.back());

  const auto edges = static_cast<GlobalIndex>(left_chain.size() + right_chain.size()) - 2;
  std::ranges::sort(left_chain);
  std::ranges::sort(right_chain);
  Numbers border;
  std::ranges::set_union(left_chain, right_chain, std::back_inserter(border));
  const auto common = static_cast<GlobalIndex>(left_chain.size() + right_chain.size() - border.size());
  const auto own_end = first_site + static_cast<GlobalIndex>(own_sites.size());
  const auto own_on_border = std::ranges::count_if(
      border, [&](GlobalIndex number) { return first_site <= number && number < own_end; });
  const auto inside = static_cast<GlobalIndex>(own_sites.size()) - own_on_border;
  return edges + 2 * inside - 2 * (common - 1);
}

} // namespace dovetail
