/// The first cuts of a large set: a balanced tree of medians of a sample. Private to divide and conquer.
#pragma once

#include "dovetail/base/types.hpp"

#include <span>
#include <vector>

namespace dovetail::divide_and_conquer {

/// A complete binary tree of `leaves` = 2^depth leaves over the plane. Branch i (1 is the root, 2i and
/// 2i + 1 its children) sends a point left if its coordinate axis[i] is less than cut[i], and so every cut
/// separates strictly. Cuts go across the longer side of what they cut: thin parts have long seams.
struct MedianTree {
  unsigned depth = 0;
  std::vector<double> cut;
  std::vector<std::uint8_t> axis;

  std::size_t leaves() const { return std::size_t{1} << depth; }
};

MedianTree median_tree(std::span<const Point> sites, unsigned depth);

/// order[start[k]] .. order[start[k + 1] - 1] are the sites of leaf k, in the order of the input. `scratch`
/// has room for one number a site.
std::vector<LocalIndex> sort_into_leaves(const MedianTree &tree, std::span<const Point> sites,
                                         std::span<LocalIndex> order, std::span<LocalIndex> scratch);

} // namespace dovetail::divide_and_conquer
