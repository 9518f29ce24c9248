#include "median_tree.hpp"

#include "sight.hpp"

#include <algorithm>
#include <array>

namespace dovetail::divide_and_conquer {
namespace {

constexpr std::size_t sample_per_leaf = 16;

struct Box {
  Point low;
  Point high;
};

Box box_of(std::span<const Point> points) {
  Box box{points.front(), points.front()};
  for (const Point &p : points) {
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y)};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y)};
  }
  return box;
}

void cut_sample(MedianTree &tree, std::span<Point> sample, std::size_t branch) {
  if (branch >= tree.leaves())
    return;
  if (sample.empty())
    return; // the cuts below keep their default, and their parts stay empty or whole
  const Box box = box_of(sample);
  // Halves, so that no difference of finite numbers overflows.
  const bool across_y = box.high.y / 2 - box.low.y / 2 > box.high.x / 2 - box.low.x / 2;
  const std::size_t half = sample.size() / 2;
  std::ranges::nth_element(sample, sample.begin() + static_cast<std::ptrdiff_t>(half), {},
                           across_y ? &Point::y : &Point::x);
  tree.cut[2 * branch + (across_y ? 1 : 0)] = across_y ? sample[half].y : sample[half].x;
  cut_sample(tree, sample.first(half), 2 * branch);
  cut_sample(tree, sample.subspan(half), 2 * branch + 1);
}

/// Finds and counts the leaves of some sites next to each other. One descent waits for itself at every level;
/// several at once wait together.
template <std::size_t together>
void find_leaves(const MedianTree &tree, const Point *sites, LocalIndex *leaf_of, LocalIndex *counts) {
  const double *const cut = tree.cut.data();
  const std::size_t leaves = tree.leaves();
  std::array<std::size_t, together> twice; // the number of the branch
  twice.fill(2);
  for (unsigned level = 0; level < tree.depth; ++level)
    for (std::size_t i = 0; i < together; ++i) {
      const Pair at_branch{cut[twice[i]], cut[twice[i] + 1]};
      const unsigned beyond = lanes_from(pair_of(sites[i]), at_branch);
      twice[i] = 2 * twice[i] + ((beyond + 1) & 2); // beyond in no lane, or in one
    }
  for (std::size_t i = 0; i < together; ++i) {
    const std::size_t leaf = twice[i] / 2 - leaves;
    leaf_of[i] = static_cast<LocalIndex>(leaf);
    ++counts[leaf];
  }
}

} // namespace

MedianTree median_tree(std::span<const Point> sites, unsigned depth) {
  MedianTree tree;
  tree.depth = depth;
  tree.cut.assign(2 * tree.leaves(), MedianTree::no_cut); // no cut at all: everything is left
  const std::size_t wanted = depth == 0 ? 0 : std::min(sites.size(), sample_per_leaf * tree.leaves());
  std::vector<Point> sample(wanted);
  for (std::size_t i = 0; i < wanted; ++i)
    sample[i] = sites[i * sites.size() / wanted];
  cut_sample(tree, sample, 1);
  return tree;
}

std::vector<LocalIndex> sort_into_leaves(const MedianTree &tree, std::span<const Point> sites,
                                         std::span<LocalIndex> corners, std::span<LocalIndex> scratch) {
  constexpr std::size_t together = 8;
  const std::size_t n = sites.size();
  LocalIndex *const leaf_of = scratch.data();
  std::vector<LocalIndex> start(tree.leaves() + 1, 0);
  LocalIndex *const counts = start.data() + 1;
  std::size_t found = 0;
  for (; found + together <= n; found += together)
    find_leaves<together>(tree, sites.data() + found, leaf_of + found, counts);
  for (; found < n; ++found)
    find_leaves<1>(tree, sites.data() + found, leaf_of + found, counts);
  for (std::size_t k = 0; k < tree.leaves(); ++k)
    start[k + 1] += start[k];
  std::vector<LocalIndex> next(start.begin(), start.end() - 1);
  for (std::size_t i = 0; i < n; ++i) {
    const auto room = static_cast<std::size_t>(next[static_cast<std::size_t>(leaf_of[i])]++);
    NumberedSite{sites[i], static_cast<LocalIndex>(i)}.store(corners.data(), room);
  }
  return start;
}

} // namespace dovetail::divide_and_conquer
