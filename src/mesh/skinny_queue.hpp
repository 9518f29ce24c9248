/// The triangles to be refined, those with the shortest edge first. Private to mesh.
#pragma once

#include "dovetail/base/types.hpp"

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

namespace dovetail {

/// First in, first out within buckets of edges that differ by less than a factor of the fourth root of two:
/// nearly the order of lengths, and neighbours, which come in together, go out together and find the caches
/// warm.
class SkinnyQueue {
public:
  /// A triangle as it was: it is still there if its face has the same corners.
  struct Entry {
    LocalIndex face;
    std::array<LocalIndex, 3> corner;
  };

  SkinnyQueue() : buckets_(bucket_count) {}

  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }

  void push(double squared_edge, const Entry &entry) {
    const std::size_t bucket = bucket_of(squared_edge);
    LocalIndex at = free_;
    if (at == none) {
      at = static_cast<LocalIndex>(links_.size());
      links_.push_back({entry, none});
    } else {
      free_ = links_[static_cast<std::size_t>(at)].next;
      links_[static_cast<std::size_t>(at)] = {entry, none};
    }
    Bucket &list = buckets_[bucket];
    if (list.first == none) {
      list.first = at;
      occupied_[bucket / 64] |= std::uint64_t{1} << (bucket % 64);
      lowest_word_ = bucket / 64 < lowest_word_ ? bucket / 64 : lowest_word_;
    } else {
      links_[static_cast<std::size_t>(list.last)].next = at;
    }
    list.last = at;
    ++size_;
  }

  /// Not empty.
  Entry pop() {
    while (occupied_[lowest_word_] == 0)
      ++lowest_word_;
    const std::size_t bucket =
        64 * lowest_word_ + static_cast<std::size_t>(std::countr_zero(occupied_[lowest_word_]));
    Bucket &list = buckets_[bucket];
    const LocalIndex at = list.first;
    Link &link = links_[static_cast<std::size_t>(at)];
    list.first = link.next;
    if (list.first == none)
      occupied_[lowest_word_] &= occupied_[lowest_word_] - 1;
    link.next = free_;
    free_ = at;
    --size_;
    return link.entry;
  }

private:
  struct Link {
    Entry entry;
    LocalIndex next;
  };
  struct Bucket {
    LocalIndex first = none, last = none;
  };
  static constexpr std::size_t bucket_count = 4096; ///< all exponents, and the first bit behind

  /// Of a double that is not negative the bits ascend with the value.
  static std::size_t bucket_of(double squared_edge) {
    return static_cast<std::size_t>(std::bit_cast<std::uint64_t>(squared_edge) >> 51);
  }

  std::vector<Bucket> buckets_;
  std::vector<Link> links_;
  std::array<std::uint64_t, bucket_count / 64> occupied_{};
  std::size_t lowest_word_ = 0;
  LocalIndex free_ = none;
  std::size_t size_ = 0;
};

} // namespace dovetail
