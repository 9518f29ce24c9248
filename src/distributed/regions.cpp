#include "dovetail/distributed/regions.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/serialization.hpp"
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
};

/// What a group learns first of a split.
struct SplitHeader {
  int border_rank = 0;
  double line = 0;
  Path approximate; ///< of the two ranks next to the line; travels behind the rest

  template <class Archive> void serialize(Archive &archive, unsigned) { archive &border_rank &line; }
};

/// One rank of a group while it splits: what it has to give, and what it keeps of the effort.
struct Member {
  const Slabs &slabs;
  Path left_hull;  ///< of all own sites at the leftmost own line
  Path right_hull; ///< at the rightmost
  GlobalIndex candidate_sites = 0;

  void note_candidates(const Path &chains) {
    candidate_sites = std::max(candidate_sites, static_cast<GlobalIndex>(chains.size()));
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
  return {best, group.first_slab[index(best)]};
}

/// Collective over the group. The ranks on both sides of the line send their hulls there, the root makes of
/// them a path that is already nearly right, and the group learns it.
SplitHeader approximate_split(const Group &group, Border border, Member &member) {
  const double position = member.slabs.lines[index(border.slab - 1)];
  const int rank = group.ranks.rank();
  const Path none_asked;
  const Path chains = gather_chains(group.ranks, rank == border.rank - 1 ? member.right_hull
                                                 : rank == border.rank   ? member.left_hull
                                                                         : none_asked);
  member.note_candidates(chains);
  SplitHeader header{border.rank, position, {}};
  header.approximate = collectively(group.ranks, candidates_text, [&] {
    return group.ranks.is_root() ? split_path(chains, {position, member.slabs.axis}) : Path();
  });
  broadcast(group.ranks, header);
  broadcast_path(group.ranks, header.approximate);
  return header;
}

/// Collective over the group. Every rank sends of its own hull what the approximate path lets through. The
/// two ranks next to the line have given all they have: what the approximate path does not contain of
/// it, is on no path of more sites either. The group's own two paths stand for all sites outside the group.
Path exact_path(const Group &group, const SplitHeader &header, Member &member) {
  const SplitLine line{header.line, member.slabs.axis};
  const int rank = group.ranks.rank();
  const auto &offsets = member.slabs.site_offsets;
  const GlobalIndex begin = offsets[index(group.first_slab.front())];
  const GlobalIndex end = offsets[index(group.first_slab.back())];

  const Path candidates = collectively(group.ranks, candidates_text, [&] {
    const PathFilter filter(header.approximate, line);
    Path admitted;
    const auto add = [&](const Path &chain, auto &&wanted) {
      std::copy_if(chain.begin(), chain.end(), std::back_inserter(admitted),
                   [&](const PathSite &site) { return wanted(site) && filter.lets_through(site.point); });
    };
    const auto all = [](const PathSite &) { return true; };
    if (rank + 1 < header.border_rank)
      add(member.right_hull, all);
    else if (rank > header.border_rank)
      add(member.left_hull, all);
    if (group.ranks.is_root()) {
      add(group.left, [&](const PathSite &site) { return site.number < begin; });
      add(group.right, [&](const PathSite &site) { return site.number >= end; });
    }
    return admitted;
  });
  Path chains = gather_chains(group.ranks, candidates);
  Path path = collectively(group.ranks, candidates_text, [&]() -> Path {
    if (!group.ranks.is_root())
      return {};
    chains.insert(chains.end(), header.approximate.begin(), header.approximate.end());
    member.note_candidates(chains);
    return split_path(chains, line);
  });
  broadcast_path(group.ranks, path);
  return path;
}

/// Collective over the group: it becomes two, which share nothing but the path.
Group half_of(Group group, const SplitHeader &header, Path path) {
  const int border = header.border_rank;
  const bool lower = group.ranks.rank() < border;
  Communicator half = group.ranks.split(lower ? 0 : 1);
  const auto cut = group.first_slab.begin() + border;
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
    const SplitHeader header = approximate_split(group, border, member);
    Path path = exact_path(group, header, member);
    group = half_of(std::move(group), header, std::move(path));
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
