#include "node_numbers.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/exchange.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace dovetail {
namespace {

template <class T> std::size_t at(T index) { return static_cast<std::size_t>(index); }

[[noreturn]] void refuse(const std::string &path, const std::string &what) {
  throw Error({ErrorKind::input, path, "", what, "check the mesh with dovetail verify, and make it again"});
}

/// An index that asks for its number.
struct Question {
  GlobalIndex index;
  GlobalIndex counts; ///< 1 for a point, 0 for a ghost that stands for it
};

/// Answers to the questions, in their order: for each index, how many points have a lower one. Local.
std::vector<GlobalIndex> rank_indices(const std::vector<Question> &questions, GlobalIndex before,
                                      const std::vector<GlobalIndex> &sorted, const std::string &path) {
  std::vector<GlobalIndex> answers;
  answers.reserve(questions.size());
  for (const Question &question : questions) {
    const auto found = std::lower_bound(sorted.begin(), sorted.end(), question.index);
    if (found == sorted.end() || *found != question.index)
      refuse(path, fmt::format("a ghost has input index {}, which no site has", question.index));
    answers.push_back(before + (found - sorted.begin()));
  }
  return answers;
}

} // namespace

NodeNumbers::NodeNumbers(const Communicator &comm, const DistributedMesh &mesh, const std::string &path)
    : mesh_(mesh) {
  check_and_count(comm, path);
  if (has_gaps_)
    number(comm, path);
}

void NodeNumbers::check_and_count(const Communicator &comm, const std::string &path) {
  GlobalIndex points = static_cast<GlobalIndex>(mesh_.duplicates.size());
  GlobalIndex largest = -1;
  collectively(comm, [&] {
    const auto look_at = [&](GlobalIndex index) {
      if (index < 0)
        refuse(path, fmt::format("a point has the input index {}", index));
      largest = std::max(largest, index);
    };
    for (const SlabMesh &slab : mesh_.slabs) {
      points += slab.own_count;
      std::for_each(slab.vertices.input_index.begin(), slab.vertices.input_index.end(), look_at);
    }
    for (const Duplicate &duplicate : mesh_.duplicates)
      look_at(duplicate.input_index);
  });
  count_ = all_reduce_sum(comm, points);
  end_index_ = all_reduce_max(comm, largest) + 1;
  has_gaps_ = end_index_ != count_;
}

void NodeNumbers::number(const Communicator &comm, const std::string &path) {
  std::vector<Question> questions;
  for (const SlabMesh &slab : mesh_.slabs) {
    first_of_slab_.push_back(questions.size());
    for (std::size_t v = 0; v < slab.vertices.input_index.size(); ++v)
      questions.push_back({slab.vertices.input_index[v], v < at(slab.own_count) ? 1 : 0});
  }
  first_of_slab_.push_back(questions.size());
  for (const Duplicate &duplicate : mesh_.duplicates)
    questions.push_back({duplicate.input_index, 1});

  // To the rank that owns the range of indices, and the answers back by the same way.
  const GlobalIndex range = end_index_ / comm.size() + 1;
  std::vector<std::int64_t> counts(at(comm.size()), 0);
  for (const Question &question : questions)
    ++counts[at(question.index / range)];
  std::vector<std::int64_t> next(counts.size(), 0);
  std::exclusive_scan(counts.begin(), counts.end(), next.begin(), std::int64_t{0});
  std::vector<Question> sent(questions.size());
  std::vector<std::int64_t> place(questions.size());
  for (std::size_t q = 0; q < questions.size(); ++q) {
    place[q] = next[at(questions[q].index / range)]++;
    sent[at(place[q])] = questions[q];
  }
  const Exchanged<Question> asked = exchange<Question>(comm, sent, counts);
  std::vector<GlobalIndex> sorted;
  for (const Question &question : asked.data)
    if (question.counts == 1)
      sorted.push_back(question.index);
  std::sort(sorted.begin(), sorted.end());
  const GlobalIndex before = exclusive_scan(comm, static_cast<GlobalIndex>(sorted.size()));
  const std::vector<GlobalIndex> answers =
      collectively(comm, [&] { return rank_indices(asked.data, before, sorted, path); });
  numbers_.resize(questions.size());
  exchange_into<GlobalIndex>(comm, answers, asked.counts, numbers_, counts);
  std::vector<GlobalIndex> in_order(numbers_.size());
  for (std::size_t q = 0; q < place.size(); ++q)
    in_order[q] = numbers_[at(place[q])];
  numbers_ = std::move(in_order);
}

} // namespace dovetail
