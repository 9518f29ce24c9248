// The paths of the larger set, found among the old ones and the new sites.
#include "insertion.hpp"

#include "dovetail/comm/collectives.hpp"
#include "dovetail/distributed/regions.hpp"

#include <fmt/format.h>

#include <numeric>
#include <utility>

namespace dovetail::insertion {
namespace {

std::string paths_text() { return "the paths of its slabs"; }

/// What the owners said of some numbers.
template <Bulk Answer> struct Answers {
  std::vector<GlobalIndex> numbers; ///< ascending
  std::vector<Answer> answers;      ///< one for each
  const Answer &of(GlobalIndex number) const {
    return answers[at(std::ranges::lower_bound(numbers, number) - numbers.begin())];
  }
};

/// Collective. Asks the owners of sites about them. `numbers` in any order, repetitions allowed; `offsets`:
/// the numbers of every slab's sites. `answer_of` is given the number of one of this rank's sites, and no
/// number twice by the same rank.
template <Bulk Answer, class AnswerOf>
Answers<Answer> ask_owners(const Communicator &comm, const DistributedMesh &mesh,
                           const std::vector<GlobalIndex> &offsets, std::vector<GlobalIndex> numbers,
                           AnswerOf &&answer_of) {
  Answers<Answer> result;
  const auto letters = collectively(comm, paths_text, [&] {
    std::ranges::sort(numbers);
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    std::vector<Outgoing<GlobalIndex>> pieces;
    auto begin = numbers.begin();
    for (int rank = 0; rank < comm.size() && begin != numbers.end(); ++rank) {
      const int beyond = first_slab_of_rank(mesh.slab_count(), rank + 1, comm.size());
      const auto end = std::lower_bound(begin, numbers.end(), offsets[at(beyond)]);
      if (end != begin)
        pieces.push_back({rank, std::span(begin, end)});
      begin = end;
    }
    return pieces;
  });
  const auto asked = sparse_exchange<GlobalIndex>(comm, letters);
  std::vector<std::vector<Answer>> replies;
  const auto back = collectively(comm, paths_text, [&] {
    std::vector<Outgoing<Answer>> pieces;
    replies.reserve(asked.size());
    for (const Incoming<GlobalIndex> &letter : asked) {
      std::vector<Answer> &reply = replies.emplace_back();
      std::ranges::transform(letter.data, std::back_inserter(reply), answer_of);
      pieces.push_back({letter.rank, reply});
    }
    return pieces;
  });
  const auto answered = sparse_exchange<Answer>(comm, back);
  collectively(comm, paths_text, [&] {
    for (const Incoming<Answer> &letter : answered) // by ascending rank, as they were asked
      result.answers.insert(result.answers.end(), letter.data.begin(), letter.data.end());
  });
  result.numbers = std::move(numbers);
  return result;
}

/// The numbers of all sites that this rank's slabs have to know: path sites and ghosts.
std::vector<GlobalIndex> numbers_to_ask(const DistributedMesh &mesh) {
  std::vector<GlobalIndex> numbers;
  for (const SlabMesh &slab : mesh.slabs) {
    numbers.insert(numbers.end(), slab.left_path.begin(), slab.left_path.end());
    numbers.insert(numbers.end(), slab.ghost_number.begin(), slab.ghost_number.end());
  }
  return numbers;
}

/// Gives ghosts the numbers that their sites will have, and sees that they are where their sites are.
void renumber_ghosts(const Answers<PathSite> &sites, DistributedMesh &mesh) {
  int s = mesh.first_slab;
  for (SlabMesh &slab : mesh.slabs) {
    for (std::size_t g = 0; g < slab.ghost_number.size(); ++g) {
      const PathSite &site = sites.of(slab.ghost_number[g]);
      if (site.point != slab.vertices.points[at(slab.own_count) + g])
        refuse_mesh(fmt::format("slab {}", s),
                    fmt::format("has a ghost that is not where site {} is", slab.ghost_number[g]));
      slab.ghost_number[g] = site.number;
    }
    ++s;
  }
}

std::vector<Path> old_left_paths(const Answers<PathSite> &sites, const DistributedMesh &mesh) {
  std::vector<Path> paths;
  for (const SlabMesh &slab : mesh.slabs) {
    Path &path = paths.emplace_back();
    for (const GlobalIndex number : slab.left_path)
      path.push_back(sites.of(number));
    const auto not_above = [&](const PathSite &a, const PathSite &b) {
      return !(along(a.point, mesh.axis) < along(b.point, mesh.axis));
    };
    if (std::ranges::adjacent_find(path, not_above) != path.end())
      refuse_mesh(fmt::format("slab {}", mesh.first_slab + std::ssize(paths) - 1),
                  "has a left path that does not ascend");
  }
  return paths;
}

/// Collective. The left path of the first slab behind this rank's: the right path of its last.
Path path_from_next_rank(const Communicator &comm, const DistributedMesh &mesh,
                         const std::vector<Path> &left_paths) {
  std::vector<Outgoing<PathSite>> letters;
  if (!left_paths.empty() && mesh.first_slab > 0)
    letters.push_back(
        {rank_of_slab(mesh.slab_count(), mesh.first_slab - 1, comm.size()), left_paths.front()});
  auto arrived = sparse_exchange<PathSite>(comm, letters);
  return arrived.empty() ? Path() : std::move(arrived.front().data);
}

/// All sites that can be on a new path, as slabs of their own: those on an old path, and the new ones.
struct Candidates {
  Slabs slabs;
  std::vector<GlobalIndex> numbers; ///< that this rank's will have as sites of the mesh
};

/// Collective. known: old numbers, ascending, of this rank's sites that are on an old path.
Candidates candidates_of(const Communicator &comm, const DistributedMesh &mesh, const Placement &placement,
                         std::span<const GlobalIndex> known) {
  Candidates candidates;
  Slabs &slabs = candidates.slabs;
  const auto counts = collectively(comm, paths_text, [&] {
    std::vector<GlobalIndex> own;
    auto next = known.begin();
    for (std::size_t k = 0; k < mesh.slabs.size(); ++k) {
      const SlabMesh &slab = mesh.slabs[k];
      const SlabArrivals arrivals = placement.arrivals(k);
      const std::span<const Point> added = placement.points(k);
      const GlobalIndex first = placement.site_offsets[at(mesh.first_slab) + k];
      const auto before = std::ssize(candidates.numbers);
      const auto add = [&](Point p, LocalIndex place) {
        slabs.sites.points.push_back(p);
        candidates.numbers.push_back(first + place);
      };
      std::size_t j = 0;
      for (; next != known.end() && *next < slab.first_site + slab.own_count; ++next) {
        const auto v = static_cast<LocalIndex>(*next - slab.first_site);
        for (; j < added.size() && arrivals.places[j] <= v; ++j)
          add(added[j], arrivals.place_of_new(j));
        add(slab.vertices.points[at(v)], arrivals.place_of_old(v));
      }
      for (; j < added.size(); ++j)
        add(added[j], arrivals.place_of_new(j));
      own.push_back(std::ssize(candidates.numbers) - before);
    }
    return own;
  });
  const std::vector<GlobalIndex> of_slabs = all_gather_bulk<GlobalIndex>(comm, counts).data;
  collectively(comm, paths_text, [&] {
    slabs.axis = mesh.axis;
    slabs.site_offsets.assign(of_slabs.size() + 1, 0);
    std::partial_sum(of_slabs.begin(), of_slabs.end(), slabs.site_offsets.begin() + 1);
    slabs.lines = mesh.lines;
    slabs.first_slab = mesh.first_slab;
    slabs.own_slab_count = static_cast<int>(mesh.slabs.size());
  });
  return candidates;
}

/// Collective. All paths around this rank's slabs, with the numbers that sites will have.
Region new_paths(const Communicator &comm, const DistributedMesh &mesh, Candidates &&candidates) {
  const std::vector<GlobalIndex> offsets = candidates.slabs.site_offsets;
  const GlobalIndex first = candidates.slabs.first_site();
  Region region = split_into_regions(comm, std::move(candidates.slabs));
  std::vector<GlobalIndex> asked;
  collectively(comm, paths_text, [&] {
    if (region.problem)
      throw Error(*region.problem);
    for (const Path &path : region.paths)
      std::ranges::transform(path, std::back_inserter(asked), &PathSite::number);
  });
  const auto numbers =
      ask_owners<GlobalIndex>(comm, mesh, offsets, std::move(asked), [&](GlobalIndex candidate) {
        return candidates.numbers[at(candidate - first)];
      });
  for (Path &path : region.paths)
    for (PathSite &site : path)
      site.number = numbers.of(site.number);
  return region;
}

} // namespace

PathUpdate update_paths(const Communicator &comm, const Placement &placement, DistributedMesh &mesh) {
  std::vector<GlobalIndex> known; // own sites that somebody asked about
  const auto answer = [&](GlobalIndex number) {
    const std::size_t s = at(slab_of_site(mesh, number)), k = s - at(mesh.first_slab);
    const auto v = static_cast<LocalIndex>(number - mesh.site_offsets[s]);
    known.push_back(number);
    return PathSite{mesh.slabs[k].vertices.points[at(v)],
                    placement.site_offsets[s] + placement.arrivals(k).place_of_old(v)};
  };
  const auto questions = collectively(comm, paths_text, [&] { return numbers_to_ask(mesh); });
  const auto sites = ask_owners<PathSite>(comm, mesh, mesh.site_offsets, questions, answer);
  std::vector<Path> old_left = collectively(comm, paths_text, [&] {
    std::ranges::sort(known);
    known.erase(std::unique(known.begin(), known.end()), known.end());
    renumber_ghosts(sites, mesh);
    return old_left_paths(sites, mesh);
  });
  const Path old_last = path_from_next_rank(comm, mesh, old_left);

  Region region = new_paths(comm, mesh, candidates_of(comm, mesh, placement, known));
  PathUpdate update;
  update.candidate_sites = region.candidate_sites;
  collectively(comm, paths_text, [&] {
    for (std::size_t k = 0; k < mesh.slabs.size(); ++k) {
      const bool last = k + 1 == mesh.slabs.size();
      update.slabs.push_back(
          {old_left[k], last ? old_last : old_left[k + 1], region.paths[k], region.paths[k + 1]});
    }
  });
  return update;
}

} // namespace dovetail::insertion
