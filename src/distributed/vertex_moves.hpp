/// Where the vertices of a slab go when new ones come between them. Private to distributed. Local.
#pragma once

#include "insertion.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dovetail::insertion {

/// New numbers for old ones, looked up for every corner of a slab's triangles. Few sites into many leave most
/// blocks of consecutive vertices with at most one new site among them, which are described by a word each: a
/// table of these words stays in the cache, which one of all vertices does not.
class VertexMoves {
public:
  /// Vertices 0 .. old_own - 1 make room for `arrivals`; those behind go where `others` says.
  VertexMoves(SlabArrivals arrivals, LocalIndex old_own, std::span<const LocalIndex> others) {
    const std::span<const LocalIndex> arriving = arrivals.places;
    const std::size_t own = at(old_own), count = own + others.size();
    words_.reserve(count / block_size + 1);
    std::size_t come = 0; // new sites at or before the vertex looked at last
    const auto come_at = [&](std::size_t vertex) {
      while (come < arriving.size() && at(arriving[come]) <= vertex)
        ++come;
      return come;
    };
    const auto arrives = [&](std::size_t j) { return j < arriving.size() ? at(arriving[j]) : own; };
    for (std::size_t first = 0, end = 0; first < count; first = end) {
      end = std::min(first + block_size, count);
      const std::size_t come_first = come_at(first);
      if (end <= own && arrives(come_first + 1) >= end) {
        words_.push_back(word(come_first, arrives(come_first)));
        continue;
      }
      words_.push_back(listed | listed_.size());
      for (std::size_t v = first; v < end; ++v)
        listed_.push_back(v < own ? static_cast<LocalIndex>(v + come_at(v)) : others[v - own]);
    }
  }

  /// Gives three vertices their new numbers. False if none can be among those behind the old own ones.
  bool move(std::span<LocalIndex, 3> vertices) const {
    const std::array<std::uint64_t, 3> words{word_of(vertices[0]), word_of(vertices[1]),
                                             word_of(vertices[2])};
    if (((words[0] | words[1] | words[2]) & listed) != 0) [[unlikely]] {
      for (LocalIndex &v : vertices)
        v = place_of(v);
      return true;
    }
    for (std::size_t i = 0; i < 3; ++i)
      vertices[i] = shifted(vertices[i], words[i]);
    return false;
  }

private:
  static constexpr int block_bits = 6;
  static constexpr std::size_t block_size = std::size_t{1} << block_bits;
  /// A block's word: how far its vertices move, and above that from which of them on one more. Or, with the
  /// highest bit set, where in listed_ its vertices begin.
  static constexpr std::uint64_t listed = std::uint64_t{1} << 63;
  static std::uint64_t word(std::size_t distance, std::size_t step) { return step << 32 | distance; }

  std::uint64_t word_of(LocalIndex v) const { return words_[at(v) >> block_bits]; }
  static LocalIndex shifted(LocalIndex v, std::uint64_t word) {
    return v + static_cast<LocalIndex>(word) +
           static_cast<LocalIndex>(v >= static_cast<LocalIndex>(word >> 32));
  }
  LocalIndex place_of(LocalIndex v) const {
    const std::uint64_t word = word_of(v);
    return (word & listed) == 0 ? shifted(v, word) : listed_[(word ^ listed) + (at(v) & (block_size - 1))];
  }

  std::vector<std::uint64_t> words_;
  std::vector<LocalIndex> listed_; ///< where vertices go, for blocks with more new sites or other vertices
};

} // namespace dovetail::insertion
