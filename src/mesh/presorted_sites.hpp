/// What the split-path recursion begins with: the sites by x and by y. Private to mesh.
#pragma once

#include "dovetail/base/types.hpp"

#include <array>
#include <span>
#include <vector>

namespace dovetail {

/// A site in the order of one axis, with its rank in the order of the other: who goes through one order can
/// tell on which side of a cut across the other axis a site is, and does not look anything up.
struct RankedSite {
  LocalIndex site;
  LocalIndex other_rank;
};

/// Sites under numbers of their own, so that sites near each other are near each other in memory: a small box
/// of the recursion then works on a few short stretches of whatever is kept by site.
struct PresortedSites {
  std::vector<Point> point;
  std::vector<LocalIndex> original;             ///< the numbers they came with
  std::array<std::vector<RankedSite>, 2> order; ///< ascending by (x, y) and by (y, x)
  std::array<std::vector<LocalIndex>, 2> rank;  ///< by site: its place in these orders
};

/// A radix sort for each axis and one of the cells of a grid: O(n), and O(n log n) where sites differ in
/// their last bits only.
PresortedSites presort(std::span<const Point> sites);

} // namespace dovetail
