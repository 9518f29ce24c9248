#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/exchange.hpp"
#include "dovetail/distributed/stitch.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>

namespace dovetail::stitching {
namespace {

/// The numbers of all ghosts of this rank's slabs, each once, ascending.
std::vector<GlobalIndex> ghosts_of(const DistributedMesh &mesh) {
  std::vector<GlobalIndex> numbers;
  for (const SlabMesh &slab : mesh.slabs)
    numbers.insert(numbers.end(), slab.ghost_number.begin(), slab.ghost_number.end());
  std::ranges::sort(numbers);
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  return numbers;
}

/// Numbers to the ranks that own them: both ascend, so what goes to one rank is a piece of the whole.
std::vector<Outgoing<GlobalIndex>> address(const Owners &owners, std::span<const GlobalIndex> numbers) {
  std::vector<Outgoing<GlobalIndex>> letters;
  for (std::size_t begin = 0, end = 0; begin < numbers.size(); begin = end) {
    const int rank = owners.rank_of_site(numbers[begin]);
    const GlobalIndex beyond = owners.first_site[static_cast<std::size_t>(rank) + 1];
    while (end < numbers.size() && numbers[end] < beyond)
      ++end;
    letters.push_back({rank, numbers.subspan(begin, end - begin)});
  }
  return letters;
}

const SlabMesh &slab_of_site(const DistributedMesh &mesh, GlobalIndex number) {
  const auto beyond = std::ranges::upper_bound(mesh.slabs, number, {}, &SlabMesh::first_site);
  return *std::prev(beyond);
}

/// One record a number: the input index, then the attributes, each as the bits of its 64.
using Word = std::uint64_t;

std::vector<Word> records_of(const DistributedMesh &mesh, std::span<const GlobalIndex> numbers) {
  std::vector<Word> words;
  for (const GlobalIndex number : numbers) {
    const SlabMesh &slab = slab_of_site(mesh, number);
    const auto vertex = static_cast<std::size_t>(number - slab.first_site);
    words.push_back(std::bit_cast<Word>(slab.vertices.input_index[vertex]));
    for (const Attribute &attribute : slab.vertices.attributes)
      words.push_back(std::bit_cast<Word>(attribute.values[vertex]));
  }
  return words;
}

void append_record(PointTable &table, const Word *record) {
  table.input_index.push_back(std::bit_cast<GlobalIndex>(*record++));
  for (Attribute &attribute : table.attributes)
    attribute.values.push_back(std::bit_cast<double>(*record++));
}

/// Completes the ghosts with records that come in the order of `numbers`, since answers come by ascending
/// rank.
void take_records(const std::vector<GlobalIndex> &numbers, const std::vector<Incoming<Word>> &answered,
                  DistributedMesh &mesh) {
  std::vector<Word> records;
  for (const Incoming<Word> &letter : answered)
    records.insert(records.end(), letter.data.begin(), letter.data.end());
  for (SlabMesh &slab : mesh.slabs) {
    const std::size_t width = 1 + slab.vertices.attributes.size();
    for (const GlobalIndex ghost : slab.ghost_number) {
      const auto position = std::ranges::lower_bound(numbers, ghost) - numbers.begin();
      append_record(slab.vertices, &records[static_cast<std::size_t>(position) * width]);
    }
  }
}

} // namespace

void complete_ghosts(const Communicator &comm, const Owners &owners, DistributedMesh &mesh) {
  complete_ghosts(
      comm, owners, [&](std::span<const GlobalIndex> numbers) { return records_of(mesh, numbers); }, mesh);
}

void complete_ghosts(const Communicator &comm, const Owners &owners, const SiteRecords &records,
                     DistributedMesh &mesh) {
  const auto purpose = [] { return "the ghosts of its slabs"; };
  std::vector<GlobalIndex> numbers;
  const auto questions = collectively(comm, purpose, [&] {
    numbers = ghosts_of(mesh);
    return address(owners, numbers);
  });
  const auto asked = sparse_exchange<GlobalIndex>(comm, questions);
  std::vector<std::vector<Word>> replies;
  const auto letters = collectively(comm, purpose, [&] {
    replies.reserve(asked.size());
    std::vector<Outgoing<Word>> back;
    back.reserve(asked.size());
    for (const Incoming<GlobalIndex> &letter : asked)
      back.push_back({letter.rank, replies.emplace_back(records(letter.data))});
    return back;
  });
  const auto answered = sparse_exchange<Word>(comm, letters);
  collectively(comm, purpose, [&] { take_records(numbers, answered, mesh); });
}

} // namespace dovetail::stitching
