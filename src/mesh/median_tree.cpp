#include "median_tree.hpp"

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
  tree.axis[branch] = across_y ? 1 : 0;
  tree.cut[branch] = across_y ? sample[half].y : sample[half].x;
  cut_sample(tree, sample.first(half), 2 * branch);
  cut_sample(tree, sample.subspan(half), 2 * branch + 1);
}

} // namespace

MedianTree median_tree(std::span<const Point> sites, unsigned depth) {
  MedianTree tree;
  tree.depth = depth;
  tree.cut.assign(tree.leaves(), 0.0);
  tree.axis.assign(tree.leaves(), 0);
  const std::size_t wanted = depth == 0 ? 0 : std::min(sites.size(), sample_per_leaf * tree.leaves());
  std::vector<Point> sample(wanted);
  for (std::size_t i = 0; i < wanted; ++i)
    sample[i] = sites[i * sites.size() / wanted];
  cut_sample(tree, sample, 1);
  return tree;
}

std::vector<LocalIndex> sort_into_leaves(const MedianTree &tree, std::span<const Point> sites,
                                         std::span<LocalIndex> order, std::span<LocalIndex> scratch) {
  std::vector<LocalIndex> start(tree.leaves() + 1, 0);
  const double *const cut = tree.cut.data();
  const std::uint8_t *const axis = tree.axis.data();
  LocalIndex *const leaf_of = scratch.data();
  LocalIndex *const counts = start.data() + 1;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const std::array<double, 2> coordinate{sites[i].x, sites[i].y};
    std::size_t branch = 1;
    for (unsigned level = 0; level < tree.depth; ++level)
      branch = 2 * branch + (coordinate[axis[branch]] >= cut[branch] ? 1 : 0);
    const std::size_t leaf = branch - tree.leaves();
    leaf_of[i] = static_cast<LocalIndex>(leaf);
    ++counts[leaf];
  }
  for (std::size_t k = 0; k < tree.leaves(); ++k)
    start[k + 1] += start[k];
  std::vector<LocalIndex> next(start.begin(), start.end() - 1);
  for (std::size_t i = 0; i < sites.size(); ++i)
    order[static_cast<std::size_t>(next[static_cast<std::size_t>(scratch[i])]++)] =
        static_cast<LocalIndex>(i);
  return start;
}

} // namespace dovetail::divide_and_conquer
