#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/exchange.hpp"
#include "dovetail/distributed/ownership.hpp"
#include "dovetail/distributed/stitch.hpp"

#include <algorithm>
#include <cassert>
#include <span>
#include <tuple>

namespace dovetail::stitching {
namespace {

/// What travels to the rendezvous.
struct Question {
  GlobalIndex low, high;
  GlobalIndex triangle;
};

/// What a rank lacks memory for, if it does.
const char *purpose_text() { return "the edges between its slabs and others"; }

bool same_edge(const auto &a, const auto &b) { return a.low == b.low && a.high == b.high; }
auto edge_of(const auto &side) { return std::tuple(side.low, side.high, side.triangle); }

std::size_t index(LocalIndex i) { return static_cast<std::size_t>(i); }

std::vector<OpenSide> collect(const DistributedMesh &mesh,
                              const std::vector<std::vector<LocalIndex>> &open_sides) {
  std::vector<OpenSide> sides;
  for (std::size_t k = 0; k < mesh.slabs.size(); ++k)
    for (const LocalIndex side : open_sides[k])
      sides.push_back(open_side(mesh.slabs[k], k, side));
  return sides;
}

void join(DistributedMesh &mesh, const OpenSide &side, GlobalIndex neighbour) {
  mesh.slabs[index(side.slab)].border_sides.push_back({side.side, neighbour});
}

/// Joins twins of this rank's own slabs and returns the others, sorted.
std::vector<OpenSide> match_own(std::vector<OpenSide> sides, DistributedMesh &mesh) {
  std::ranges::sort(sides, {}, edge_of<OpenSide>);
  std::vector<OpenSide> alone;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (i + 1 < sides.size() && same_edge(sides[i], sides[i + 1])) {
      join(mesh, sides[i], sides[i + 1].triangle);
      join(mesh, sides[i + 1], sides[i].triangle);
      ++i;
    } else {
      alone.push_back(sides[i]);
    }
  }
  return alone;
}

/// Questions to the owners of the lower sites. Both are in ascending order, so what goes to one rank
/// is a piece of the whole.
std::vector<Outgoing<Question>> address(const Owners &owners, std::span<const Question> questions) {
  std::vector<Outgoing<Question>> letters;
  for (std::size_t begin = 0, end = 0; begin < questions.size(); begin = end) {
    const int rank = owners.rank_of_site(questions[begin].low);
    const GlobalIndex beyond = owners.first_site[index(rank + 1)];
    while (end < questions.size() && questions[end].low < beyond)
      ++end;
    letters.push_back({rank, questions.subspan(begin, end - begin)});
  }
  return letters;
}

/// At the rendezvous: for every question the triangle on the edge's other side, or `none`.
std::vector<std::vector<GlobalIndex>> answer(const std::vector<Incoming<Question>> &letters) {
  struct Asked {
    GlobalIndex low, high, triangle;
    std::size_t letter, position;
  };
  std::vector<Asked> asked;
  std::vector<std::vector<GlobalIndex>> answers(letters.size());
  for (std::size_t l = 0; l < letters.size(); ++l) {
    answers[l].assign(letters[l].data.size(), none);
    for (std::size_t p = 0; p < letters[l].data.size(); ++p) {
      const Question &question = letters[l].data[p];
      asked.push_back({question.low, question.high, question.triangle, l, p});
    }
  }
  std::ranges::sort(asked, {}, edge_of<Asked>);
  for (std::size_t i = 1; i < asked.size(); ++i)
    if (same_edge(asked[i - 1], asked[i])) {
      answers[asked[i - 1].letter][asked[i - 1].position] = asked[i].triangle;
      answers[asked[i].letter][asked[i].position] = asked[i - 1].triangle;
    }
  return answers;
}

std::vector<Outgoing<GlobalIndex>> address_back(const std::vector<Incoming<Question>> &letters,
                                                const std::vector<std::vector<GlobalIndex>> &answers) {
  std::vector<Outgoing<GlobalIndex>> back;
  for (std::size_t l = 0; l < letters.size(); ++l)
    back.push_back({letters[l].rank, answers[l]});
  return back;
}

/// Joins the sides that were asked about, in the order of `alone`, and returns how many are on the hull.
GlobalIndex join_answered(const std::vector<OpenSide> &alone,
                          const std::vector<Incoming<GlobalIndex>> &answered, DistributedMesh &mesh) {
  // Answers come by ascending rank, as the questions went.
  auto side = alone.begin();
  GlobalIndex hull_edges = 0;
  for (const Incoming<GlobalIndex> &letter : answered)
    for (const GlobalIndex neighbour : letter.data) {
      if (neighbour == none)
        ++hull_edges;
      else
        join(mesh, *side, neighbour);
      ++side;
    }
  assert(side == alone.end());
  for (SlabMesh &slab : mesh.slabs)
    std::ranges::sort(slab.border_sides, {}, &BorderSide::side);
  return hull_edges;
}

} // namespace

OpenSide open_side(const SlabMesh &slab, std::size_t k, LocalIndex side) {
  const LocalIndex triangle = side / 3, corner = side % 3;
  const auto vertex = [&](LocalIndex i) {
    return number_of_vertex(slab, slab.triangles.corners[index(3 * triangle + i % 3)]);
  };
  const GlobalIndex from = vertex(corner + 1), to = vertex(corner + 2);
  return {std::min(from, to), std::max(from, to), slab.first_triangle + triangle,
          static_cast<std::int32_t>(k), side};
}

void match_open_sides(const Communicator &comm, const Owners &owners,
                      const std::vector<std::vector<LocalIndex>> &open_sides, DistributedMesh &mesh) {
  match_open_sides(comm, owners, collectively(comm, purpose_text, [&] { return collect(mesh, open_sides); }),
                   mesh);
}

void match_open_sides(const Communicator &comm, const Owners &owners, std::vector<OpenSide> open_sides,
                      DistributedMesh &mesh) {
  std::vector<OpenSide> alone;
  std::vector<Question> questions;
  const auto letters = collectively(comm, purpose_text, [&] {
    alone = match_own(std::move(open_sides), mesh);
    questions.reserve(alone.size());
    for (const OpenSide &side : alone)
      questions.push_back({side.low, side.high, side.triangle});
    return address(owners, questions);
  });
  const auto asked = sparse_exchange<Question>(comm, letters);
  std::vector<std::vector<GlobalIndex>> answers;
  const auto replies = collectively(comm, purpose_text, [&] {
    answers = answer(asked);
    return address_back(asked, answers);
  });
  const auto answered = sparse_exchange<GlobalIndex>(comm, replies);
  mesh.hull_edges = all_reduce_sum(
      comm, collectively(comm, purpose_text, [&] { return join_answered(alone, answered, mesh); }));
}

} // namespace dovetail::stitching
