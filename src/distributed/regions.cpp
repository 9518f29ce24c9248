#include "dovetail/distributed/regions.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/distributed/regions_scan.hpp"
#include "path_travel.hpp"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <utility>

namespace dovetail {
namespace {

std::size_t index(int k) { return static_cast<std::size_t>(k); }

/// Ranks that own consecutive slabs, all of them at least one, and the paths around them.
struct Group {
  Communicator ranks;
  std::vector<int> first_slab; ///< of every rank, and at the end the first slab beyond the group
  Path left, right;            ///< empty where the group is outermost
};

/// Where a group is cut: before slab `slab`, which is the first of the group's rank `rank`.
struct Border {
  int rank;
  int slab;
  int maker; ///< of the path: of the two ranks next to the line that with more sites, which has more of it
};

/// One rank of a group while it splits: what it has to give, and what it keeps of the effort.
struct Member {
  const Slabs &slabs;
  Path left_hull;  ///< of all own sites at the leftmost own line
  Path right_hull; ///< at the rightmost
  GlobalIndex candidate_sites = 0;

  void note_candidates(std::size_t sites) {
    candidate_sites = std::max(candidate_sites, static_cast<GlobalIndex>(sites));
  }
};

/// What a rank lacks memory for, if it does.
std::string candidates_text() { return "the candidates for a split path"; }

/// The rank border nearest to the median of the group's sites; among equals the one nearest to the middle
/// rank. Every rank finds the same.
Border median_border(const Group &group, const std::vector<GlobalIndex> &site_offsets) {
  const auto sites_up_to = [&](int rank) { return site_offsets[index(group.first_slab[index(rank)])]; };
  const int ranks = group.ranks.size();
  const GlobalIndex twice_median = sites_up_to(0) + sites_up_to(ranks);
  const auto distance = [&](int rank) {
    return std::pair(std::abs(2 * sites_up_to(rank) - twice_median), std::abs(2 * rank - ranks));
  };
  int best = 1;
  for (int rank = 2; rank < ranks; ++rank)
    best = distance(rank) < distance(best) ? rank : best;
  const bool left_has_more = 2 * sites_up_to(best) > sites_up_to(best - 1) + sites_up_to(best + 1);
  return {best, group.first_slab[index(best)], left_has_more ? best - 1 : best};
}

SplitLine line_of(const Border &border, const Slabs &slabs) {
  return {slabs.lines[index(border.slab - 1)], slabs.axis};
}

/// All that a rank can have on the path of the line.
const Path &hull_towards(const Border &border, int rank, const Member &member) {
  return rank < border.rank ? member.right_hull : member.left_hull;
}

/// A path without sites that are close together: where it had no gap longer than `gap`, there is none now. It
/// is the path of the sites it has.
Path thinned(const Path &path, double gap, Axis axis) {
  Path kept;
  for (std::size_t i = 0; i < path.size(); ++i)
    if (i == 0 || i + 1 == path.size() ||
        along(path[i + 1].point, axis) - along(kept.back().point, axis) > gap)
      kept.push_back(path[i]);
  return kept;
}

/// How far a rank's slabs reach across; 0 if they have no end.
double width_of(const Slabs &slabs) {
  const int beyond = slabs.first_slab + slabs.own_slab_count;
  return slabs.first_slab > 0 && beyond < slabs.slab_count()
             ? slabs.lines[index(beyond - 1)] - slabs.lines[index(slabs.first_slab - 1)]
             : 0;
}

/// The path of what the maker knows without asking: its own hull, and the group's own two paths, which stand
/// for all sites outside the group. Where slabs are thin, as far from the middle of a heavy tail, those two
/// are nearly the path.
Path known_path(const Group &group, const Border &border, const Member &member) {
  const SplitLine line = line_of(border, member.slabs);
  const auto &offsets = member.slabs.site_offsets;
  const GlobalIndex begin = offsets[index(group.first_slab.front())];
  const GlobalIndex end = offsets[index(group.first_slab.back())];
  const auto with = [&](const Path &path, const Path &chain, auto &&is_outside) {
    Path outside;
    std::ranges::copy_if(chain, std::back_inserter(outside), is_outside, &PathSite::number);
    return outside.empty() ? path : hull_of_both(path, outside, line);
  };
  const Path of_left = with(hull_towards(border, border.maker, member), group.left,
                            [&](GlobalIndex number) { return number < begin; });
  return with(of_left, group.right, [&](GlobalIndex number) { return number >= end; });
}

/// Collective over the group, which learns the path. The maker makes one of what it knows, and every other
/// rank sends of its own hull what that lets through. To tell what matters a part of that path will do: gaps
/// of a quarter of the maker's width let through hardly more of the slabs beyond, and travel in less time.
Path path_at(const Group &group, const Border &border, Member &member) {
  const SplitLine line = line_of(border, member.slabs);
  const bool makes = group.ranks.rank() == border.maker;
  Path known, approximate; // of the maker
  collectively(group.ranks, candidates_text, [&] {
    if (makes) {
      known = known_path(group, border, member);
      approximate = thinned(known, width_of(member.slabs) / 4, line.axis);
    }
  });
  broadcast_path(group.ranks, approximate, border.maker);
  const Path admitted = collectively(group.ranks, candidates_text, [&] {
    const PathFilter filter(approximate, line);
    Path result;
    if (!makes)
      std::ranges::copy_if(
          hull_towards(border, group.ranks.rank(), member), std::back_inserter(result),
          [&](Point site) { return filter.lets_through(site); }, &PathSite::point);
    return result;
  });
  Path chains = gather_chains(group.ranks, admitted, border.maker);
  Path path = collectively(group.ranks, candidates_text, [&]() -> Path {
    if (!makes)
      return {};
    member.note_candidates(chains.size() + known.size());
    return hull_of_both(split_path(std::move(chains), line), known, line);
  });
  broadcast_path(group.ranks, path, border.maker);
  return path;
}

/// Collective over the group: it becomes two, which share nothing but the path.
Group half_of(Group group, const Border &border, Path path) {
  const bool lower = group.ranks.rank() < border.rank;
  Communicator half = group.ranks.split(lower ? 0 : 1);
  const auto cut = group.first_slab.begin() + border.rank;
  if (lower)
    return {std::move(half), {group.first_slab.begin(), cut + 1}, std::move(group.left), std::move(path)};
  return {std::move(half), {cut, group.first_slab.end()}, std::move(path), std::move(group.right)};
}

/// Collective over `comm`. The ranks that own slabs, of which there may be fewer than ranks, as one group.
Group group_of_owners(const Communicator &comm, const Slabs &slabs) {
  std::vector<int> first_slab;
  for (int first : all_gather(comm, slabs.own_slab_count > 0 ? slabs.first_slab : none))
    if (first != none)
      first_slab.push_back(first);
  first_slab.push_back(static_cast<int>(slabs.site_offsets.size()) - 1);
  return {comm.split(slabs.own_slab_count > 0 ? 0 : 1), std::move(first_slab), {}, {}};
}

/// The two paths around this rank's own slabs. Collective over ever smaller groups.
Group split_down_to_one(Group group, Member &member) {
  while (group.ranks.size() > 1) {
    const Border border = median_border(group, member.slabs.site_offsets);
    Path path = path_at(group, border, member);
    group = half_of(std::move(group), border, std::move(path));
  }
  return group;
}

} // namespace

Region split_into_regions(const Communicator &comm, Slabs &&slabs) {
  Region region{std::move(slabs), {}, 0, std::nullopt};
  struct Hulls {
    SlabHulls slabs;
    Path left, right; ///< of all own slabs together
  };
  const auto purpose = [] { return "the paths of its slabs"; };
  Hulls hulls = collectively(comm, purpose, [&] {
    Hulls result{slab_hulls(region.slabs), {}, {}};
    if (region.slabs.own_slab_count > 0) {
      result.right = forward_scan(region.slabs, result.slabs, {}).back();
      result.left = backward_scan(region.slabs, result.slabs, {}).front();
    }
    return result;
  });
  Group group = group_of_owners(comm, region.slabs);
  if (region.slabs.own_slab_count == 0)
    return region;

  Member member{region.slabs, std::move(hulls.left), std::move(hulls.right), 0};
  try {
    // What goes wrong here, the group has agreed on, and leaves together.
    group = split_down_to_one(std::move(group), member);
    region.paths = scan_paths(region.slabs, hulls.slabs, group.left, group.right);
  } catch (...) {
    region.problem = current_problem(comm, purpose);
  }
  region.candidate_sites = member.candidate_sites;
  return region;
}

} // namespace dovetail
