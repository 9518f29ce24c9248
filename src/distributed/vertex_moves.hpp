/// Where the vertices of a slab go when new ones come between them. Private to distributed. Local.
#pragma once

#include "insertion.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace dovetail::insertion {

/// New numbers for old ones, looked up for every corner of a slab's triangles. Few sites into many leave most
/// blocks of consecutive vertices with at most one new site among them, which are described by a word each: a
/// table of these words stays in the cache, which one of all vertices does not.
class VertexMoves {
public:
  /// Vertices 0 .. old_own - 1 make room for `arrivals`; those behind go where `others` says.
  VertexMoves(SlabArrivals arrivals, LocalIndex old_own, std::span<const LocalIndex> others)
      : old_own_(old_own) {
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
        words_.push_back(word(arrives(come_first), come_first + 1));
        continue;
      }
      words_.push_back(listed | listed_.size());
      for (std::size_t v = first; v < end; ++v)
        listed_.push_back(v < own ? static_cast<LocalIndex>(v + come_at(v)) : others[v - own]);
    }
  }

  /// Gives vertices their new numbers, and returns where in the span those are that came behind the old own
  /// ones. Their order is as good as random, so four of them go together and without a branch, unless one is
  /// in a block that is listed.
  std::vector<std::size_t> move(std::span<LocalIndex> vertices) const {
    std::vector<std::size_t> behind;
    const auto move_alone = [&](std::size_t i) {
      if (vertices[i] >= old_own_)
        behind.push_back(i);
      vertices[i] = place_of(vertices[i]);
    };
    std::size_t i = 0;
    for (; i + 4 <= vertices.size(); i += 4)
      if (!move_four(&vertices[i])) [[unlikely]]
        for (std::size_t k = 0; k < 4; ++k)
          move_alone(i + k);
    for (; i < vertices.size(); ++i)
      move_alone(i);
    return behind;
  }

private:
  static constexpr int block_bits = 6;
  static constexpr std::size_t block_size = std::size_t{1} << block_bits;
  /// A block's word: how far its last vertices move, and above that from which vertex on they do; those
  /// before it move one less. Or, with the highest bit set, where in listed_ its vertices begin.
  static constexpr std::uint64_t listed = std::uint64_t{1} << 63;
  static std::uint64_t word(std::size_t step, std::size_t distance) { return step << 32 | distance; }

  using FourVertices [[gnu::vector_size(16)]] = LocalIndex;
  using TwoWords [[gnu::vector_size(16)]] = std::uint64_t;

  /// False, and nothing done, if one of the four is in a block that is listed.
  bool move_four(LocalIndex *vertices) const {
    const TwoWords low{word_of(vertices[0]), word_of(vertices[1])};
    const TwoWords high{word_of(vertices[2]), word_of(vertices[3])};
    const TwoWords any = low | high;
    if (((any[0] | any[1]) & listed) != 0) [[unlikely]]
      return false;
    // Halves of words in the order of memory: all distances, and all steps.
    const auto one = std::bit_cast<FourVertices>(low), other = std::bit_cast<FourVertices>(high);
    constexpr int first = std::endian::native == std::endian::little ? 0 : 1, second = 1 - first;
    const FourVertices distance = __builtin_shufflevector(one, other, first, first + 2, first + 4, first + 6);
    const FourVertices step = __builtin_shufflevector(one, other, second, second + 2, second + 4, second + 6);
    FourVertices moved;
    std::memcpy(&moved, vertices, sizeof moved);
    moved = moved + distance + (step > moved); // a comparison that holds is -1
    std::memcpy(vertices, &moved, sizeof moved);
    return true;
  }

  std::uint64_t word_of(LocalIndex v) const { return words_[at(v) >> block_bits]; }
  static LocalIndex shifted(LocalIndex v, std::uint64_t word) {
    return v + static_cast<LocalIndex>(word) -
           static_cast<LocalIndex>(v < static_cast<LocalIndex>(word >> 32));
  }
  LocalIndex place_of(LocalIndex v) const {
    const std::uint64_t word = word_of(v);
    return (word & listed) == 0 ? shifted(v, word) : listed_[(word ^ listed) + (at(v) & (block_size - 1))];
  }

  LocalIndex old_own_;
  std::vector<std::uint64_t> words_;
  std::vector<LocalIndex> listed_; ///< where vertices go, for blocks with more new sites or other vertices
};

} // namespace dovetail::insertion
