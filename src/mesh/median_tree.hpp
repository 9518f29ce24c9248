/// The first cuts of a large set: a balanced tree of medians of a sample. Private to divide and conquer.
#pragma once

#include "dovetail/base/types.hpp"

#include <cstddef>
#include <cstring>
#include <limits>
#include <span>
#include <vector>

namespace dovetail::divide_and_conquer {

/// A complete binary tree of `leaves` = 2^depth leaves over the plane. Branch i (1 is the root, 2i and
/// 2i + 1 its children) sends a point right if its x is at least cut[2i] or its y at least cut[2i + 1], of
/// which one is infinite. So every cut separates strictly, and both coordinates are compared at once,
/// whichever is cut. Cuts go across the longer side of what they cut: thin parts have long seams.
struct MedianTree {
  unsigned depth = 0;
  std::vector<double> cut;

  std::size_t leaves() const { return std::size_t{1} << depth; }
  unsigned axis(std::size_t branch) const { return cut[2 * branch] == no_cut ? 1 : 0; }

  static constexpr double no_cut = std::numeric_limits<double>::infinity();
};

MedianTree median_tree(std::span<const Point> sites, unsigned depth);

/// A site with its number, on its way to where it is triangulated. It travels in the room of six corners of
/// triangles, as many as it will have: that memory is there anyway, and is free until then.
struct NumberedSite {
  Point point;
  LocalIndex number;

  void store(void *rooms, std::size_t i) const {
    std::memcpy(static_cast<std::byte *>(rooms) + i * sizeof *this, this, sizeof *this);
  }
  static NumberedSite load(const void *rooms, std::size_t i) {
    NumberedSite site;
    std::memcpy(&site, static_cast<const std::byte *>(rooms) + i * sizeof site, sizeof site);
    return site;
  }
};
static_assert(sizeof(NumberedSite) == 6 * sizeof(LocalIndex));

/// Puts the sites of leaf k, in the order of the input, into the rooms start[k] .. start[k + 1] - 1; returns
/// `start`. There are six corners and one element of `scratch` for every site.
std::vector<LocalIndex> sort_into_leaves(const MedianTree &tree, std::span<const Point> sites,
                                         std::span<LocalIndex> corners, std::span<LocalIndex> scratch);

} // namespace dovetail::divide_and_conquer
