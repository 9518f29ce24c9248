#include "dovetail/distributed/triangulate_region.hpp"
#include "dovetail/geometry/predicates.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace dovetail {
namespace {

using Numbers = std::vector<GlobalIndex>;

Numbers numbers_of(const Path &path) {
  Numbers numbers;
  std::ranges::transform(path, std::back_inserter(numbers), &PathSite::number);
  return numbers;
}

/// All sites that a slab is made of, in the total order, which is that of their numbers.
class Sites {
public:
  Sites(std::span<const Point> own, GlobalIndex first, const Path &left, const Path &right)
      : own_(own), first_(first) {
    for (const Path *path : {&left, &right})
      std::ranges::copy_if(*path, std::back_inserter(foreign_),
                           [&](const PathSite &site) { return !is_own(site.number); });
    std::ranges::sort(foreign_, {}, &PathSite::number);
    const auto same = [](const PathSite &a, const PathSite &b) { return a.number == b.number; };
    foreign_.erase(std::unique(foreign_.begin(), foreign_.end(), same), foreign_.end());
    before_ = static_cast<std::size_t>(std::ranges::lower_bound(foreign_, first, {}, &PathSite::number) -
                                       foreign_.begin());
  }

  std::size_t count() const { return own_.size() + foreign_.size(); }
  bool is_own(GlobalIndex number) const {
    return first_ <= number && number < first_ + static_cast<GlobalIndex>(own_.size());
  }
  PathSite operator[](std::size_t i) const {
    if (i < before_)
      return foreign_[i];
    if (i < before_ + own_.size())
      return {own_[i - before_], first_ + static_cast<GlobalIndex>(i - before_)};
    return foreign_[i - own_.size()];
  }

  /// Calls visit(site) for every one, in the total order or backwards.
  template <class Visit> void for_each(bool forwards, Visit &&visit) const {
    const auto run = [&](std::size_t begin, std::size_t end, auto &&site) {
      for (std::size_t k = 0; k < end - begin; ++k)
        visit(site(forwards ? begin + k : end - 1 - k));
    };
    const auto own = [&](std::size_t v) { return PathSite{own_[v], first_ + static_cast<GlobalIndex>(v)}; };
    const auto foreign = [&](std::size_t i) { return foreign_[i]; };
    const std::size_t beyond = foreign_.size();
    forwards ? run(0, before_, foreign) : run(before_, beyond, foreign);
    run(0, own_.size(), own);
    forwards ? run(before_, beyond, foreign) : run(0, before_, foreign);
  }

private:
  std::span<const Point> own_;
  GlobalIndex first_;
  Path foreign_;
  std::size_t before_; ///< foreign sites before the own ones
};

bool all_collinear(const Sites &sites) {
  const Point first = sites[0].point, last = sites[sites.count() - 1].point;
  for (std::size_t i = 1; i + 1 < sites.count(); ++i)
    if (orientation(first, last, sites[i].point) != Sign::zero)
      return false;
  return true;
}

/// The convex hull's chain at lower (or higher) across, upwards from the lowest to the highest row, collinear
/// sites included. From the first (last) site of all in the total order the chain goes both ways, up and
/// down, and never back in `across`: so only a site that is lower or higher than all before it can be on it.
Path hull_chain(const Sites &sites, Axis axis, bool lower_side) {
  const PathSite first = sites[lower_side ? 0 : sites.count() - 1];
  Path downwards{first}, upwards;
  double lowest = along(first.point, axis), highest = lowest;
  sites.for_each(lower_side, [&](const PathSite &site) {
    const double row = along(site.point, axis);
    if (row < lowest) {
      downwards.push_back(site);
      lowest = row;
    } else if (row > highest) {
      upwards.push_back(site);
      highest = row;
    }
  });
  std::ranges::reverse(downwards);
  downwards.insert(downwards.end(), upwards.begin(), upwards.end());

  const Sign outwards = (axis == Axis::x) == lower_side ? Sign::positive : Sign::negative;
  Path chain;
  for (const PathSite &site : downwards) {
    while (chain.size() >= 2 &&
           orientation(chain[chain.size() - 2].point, chain.back().point, site.point) == outwards)
      chain.pop_back();
    chain.push_back(site);
  }
  return chain;
}

/// The sites of the row through `from` and `to` that lie behind `from`, up to `to`.
Numbers row_between(const Sites &sites, Axis axis, const PathSite &from, const PathSite &to) {
  Numbers row;
  if (from.number == to.number)
    return row;
  for (std::size_t i = 0; i < sites.count(); ++i) {
    const PathSite site = sites[i];
    if (along(site.point, axis) == along(from.point, axis) && from.number < site.number &&
        site.number <= to.number)
      row.push_back(site.number);
  }
  return row;
}

/// A chain from its lowest to its highest site as edges, each with the lower number first; ascending.
using Edge = std::pair<GlobalIndex, GlobalIndex>;
std::vector<Edge> edges_of(const Numbers &chain) {
  std::vector<Edge> edges;
  for (std::size_t i = 1; i < chain.size(); ++i)
    edges.push_back(std::minmax({chain[i - 1], chain[i]}));
  std::ranges::sort(edges);
  return edges;
}

/// The ends of all edges that are on one chain alone, where the slab is more than an edge; each once.
Numbers ends_of_single_edges(const Numbers &left, const Numbers &right) {
  std::vector<Edge> single;
  std::ranges::set_symmetric_difference(edges_of(left), edges_of(right), std::back_inserter(single));
  Numbers ends;
  for (const Edge &edge : single)
    ends.insert(ends.end(), {edge.first, edge.second});
  std::ranges::sort(ends);
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  return ends;
}

/// What bounds a slab on both sides, each from below to above.
struct Chains {
  Numbers left, right;
};

/// Empty if the slab has no triangles at all.
Chains chains_around(const Sites &sites, const Path &left, const Path &right, Axis axis) {
  if (sites.count() < 3 || all_collinear(sites))
    return {};
  const Path left_core = left.empty() ? hull_chain(sites, axis, true) : left;
  const Path right_core = right.empty() ? hull_chain(sites, axis, false) : right;
  Chains chains{row_between(sites, axis, left_core.front(), right_core.front()), numbers_of(right_core)};
  std::ranges::reverse(chains.left);
  std::ranges::copy(numbers_of(left_core), std::back_inserter(chains.left));
  std::ranges::copy(row_between(sites, axis, left_core.back(), right_core.back()),
                    std::back_inserter(chains.left));
  return chains;
}

GlobalIndex ghosts_of(const Sites &sites, const Chains &chains) {
  const Numbers used = ends_of_single_edges(chains.left, chains.right);
  return std::ranges::count_if(used, [&](GlobalIndex number) { return !sites.is_own(number); });
}

GlobalIndex triangles_inside(const Sites &sites, GlobalIndex own_count, Chains &&chains) {
  if (chains.right.empty())
    return 0;
  const auto edges = static_cast<GlobalIndex>(chains.left.size() + chains.right.size()) - 2;
  std::ranges::sort(chains.left);
  std::ranges::sort(chains.right);
  Numbers border;
  std::ranges::set_union(chains.left, chains.right, std::back_inserter(border));
  const auto common = static_cast<GlobalIndex>(chains.left.size() + chains.right.size() - border.size());
  const auto is_own = [&](GlobalIndex number) { return sites.is_own(number); };
  const auto inside = own_count - std::ranges::count_if(border, is_own);
  return edges + 2 * inside - 2 * (common - 1);
}

} // namespace

SlabCounts counts_between(std::span<const Point> own_sites, GlobalIndex first_site, const Path &left,
                          const Path &right, Axis axis) {
  const Sites sites(own_sites, first_site, left, right);
  Chains chains = chains_around(sites, left, right, axis);
  SlabCounts counts;
  counts.ghosts = ghosts_of(sites, chains);
  counts.triangles = triangles_inside(sites, std::ssize(own_sites), std::move(chains));
  return counts;
}

GlobalIndex triangles_between(std::span<const Point> own_sites, GlobalIndex first_site, const Path &left,
                              const Path &right, Axis axis) {
  const Sites sites(own_sites, first_site, left, right);
  return triangles_inside(sites, std::ssize(own_sites), chains_around(sites, left, right, axis));
}

} // namespace dovetail
