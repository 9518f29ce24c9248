/// The triangles to be refined, in the order that makes the fewest Steiner points. Private to mesh.
#pragma once

#include "dovetail/base/types.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

namespace dovetail {

/// Shortest edge first keeps meshes small, but jumps about in memory. What counts is the order among
/// neighbours, so edges are told apart in three steps: by classes of a factor of the root of two, then by the
/// tile (a few thousand vertices that are near each other), then by sixteenths of a class. First in, first
/// out within these. Measured on a million uniform points at 30 degrees: as few points as by sixteenths
/// alone, in two thirds of the time; without classes 2 % more points, and at 33 degrees half as many again.
class SkinnyQueue {
public:
  using Tile = std::int32_t; ///< number in Tiles
  /// A triangle as it was: it is still there if its face has the same corners.
  struct Entry {
    LocalIndex face;
    std::array<LocalIndex, 3> corner;
    Tile tile;
  };

  explicit SkinnyQueue(Tile tiles) : buckets_of_class_(static_cast<std::size_t>(tiles) * steps) {}

  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }

  /// The square of the shortest edge, not negative.
  void push(double squared_edge, const Entry &entry) {
    // Of a double that is not negative the bits ascend with the value.
    const std::uint64_t bits = std::bit_cast<std::uint64_t>(squared_edge);
    const std::size_t place = bits >> mantissa_bits;
    const std::size_t step = bits >> (mantissa_bits - step_bits) & (steps - 1);
    Class &among = classes_[place];
    if (among.buckets.empty()) {
      among.buckets.resize(buckets_of_class_);
      among.occupied.resize(buckets_of_class_ / 64 + 1);
    }
    const std::size_t bucket = static_cast<std::size_t>(entry.tile) * steps + step;
    const LocalIndex at = new_link(entry);
    Bucket &list = among.buckets[bucket];
    if (list.first == none) {
      list.first = at;
      among.occupied[bucket / 64] |= std::uint64_t{1} << (bucket % 64);
      among.lowest_word = std::min(among.lowest_word, bucket / 64);
    } else {
      links_[static_cast<std::size_t>(list.last)].next = at;
    }
    list.last = at;
    ++among.size;
    lowest_class_ = std::min(lowest_class_, place);
    ++size_;
  }

  /// Not empty.
  Entry pop() {
    while (classes_[lowest_class_].size == 0)
      ++lowest_class_;
    Class &among = classes_[lowest_class_];
    while (among.occupied[among.lowest_word] == 0)
      ++among.lowest_word;
    std::uint64_t &word = among.occupied[among.lowest_word];
    Bucket &list = among.buckets[64 * among.lowest_word + static_cast<std::size_t>(std::countr_zero(word))];
    const LocalIndex at = list.first;
    Link &link = links_[static_cast<std::size_t>(at)];
    list.first = link.next;
    if (list.first == none)
      word &= word - 1;
    link.next = free_;
    free_ = at;
    --among.size;
    --size_;
    return link.entry;
  }

private:
  static constexpr int mantissa_bits = 52;
  static constexpr int step_bits = 4;
  static constexpr std::size_t steps = std::size_t{1} << step_bits;

  struct Link {
    Entry entry;
    LocalIndex next;
  };
  struct Bucket {
    LocalIndex first = none, last = none;
  };
  struct Class {
    std::vector<Bucket> buckets; ///< by tile, then by step; made when first needed
    std::vector<std::uint64_t> occupied;
    std::size_t lowest_word = 0; ///< none below is occupied
    std::size_t size = 0;
  };

  LocalIndex new_link(const Entry &entry) {
    if (free_ == none) {
      links_.push_back({entry, none});
      return static_cast<LocalIndex>(links_.size() - 1);
    }
    const LocalIndex at = free_;
    free_ = links_[static_cast<std::size_t>(at)].next;
    links_[static_cast<std::size_t>(at)] = {entry, none};
    return at;
  }

  std::size_t buckets_of_class_;
  std::vector<Class> classes_ = std::vector<Class>(2048); ///< by exponent
  std::vector<Link> links_;
  LocalIndex free_ = none;
  std::size_t lowest_class_ = 2047; ///< none below has entries
  std::size_t size_ = 0;
};

} // namespace dovetail
