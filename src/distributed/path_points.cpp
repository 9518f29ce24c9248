#include "dovetail/distributed/path_points.hpp"

#include "validation.hpp"

#include <algorithm>

namespace dovetail {
namespace {

using validation::at;

/// A place in some rank's paths, and the site that is there.
struct Question {
  GlobalIndex site;
  std::int64_t place;
  std::int64_t rank;
};
struct Answer {
  std::int64_t place;
  std::int64_t rank;
  Point point;
};

} // namespace

std::vector<std::vector<Point>> path_points(const Communicator &comm, const DistributedMesh &mesh) {
  std::vector<int> firsts = all_gather(comm, mesh.first_slab);
  firsts.push_back(mesh.slab_count());
  const validation::Ownership owners(mesh, std::move(firsts));
  std::vector<Question> questions;
  for (const SlabMesh &slab : mesh.slabs)
    for (const GlobalIndex site : slab.left_path)
      questions.push_back({site, static_cast<std::int64_t>(questions.size()), comm.rank()});
  const std::size_t asked = questions.size();
  questions =
      validation::deliver(comm, questions, [&](const Question &q) { return owners.rank_of_site(q.site); });

  std::vector<Answer> answers;
  answers.reserve(questions.size());
  for (const Question &q : questions) {
    const int s = owners.slab_of_site(q.site);
    const SlabMesh &slab = mesh.slabs[at(s - mesh.first_slab)];
    answers.push_back(
        {q.place, q.rank, validation::point_of(slab, static_cast<LocalIndex>(q.site - slab.first_site))});
  }
  answers = validation::deliver(comm, answers, [](const Answer &a) { return static_cast<int>(a.rank); });
  std::vector<Point> all(asked);
  for (const Answer &answer : answers)
    all[at(answer.place)] = answer.point;

  std::vector<std::vector<Point>> paths;
  auto next = all.begin();
  for (const SlabMesh &slab : mesh.slabs) {
    const auto end = next + static_cast<std::ptrdiff_t>(slab.left_path.size());
    paths.emplace_back(next, end);
    next = end;
  }
  return paths;
}

} // namespace dovetail
