#include "feature_tree.hpp"

#include "dovetail/geometry/constructions.hpp"

#include <algorithm>
#include <bit>

namespace dovetail {
namespace {

template <class Index> constexpr std::size_t index(Index i) { return static_cast<std::size_t>(i); }

} // namespace

void Box::add(Point p) {
  low = {std::min(low.x, p.x), std::min(low.y, p.y)};
  high = {std::max(high.x, p.x), std::max(high.y, p.y)};
}

double Box::squared_distance_from(Point p) const {
  const double x = std::max({low.x - p.x, p.x - high.x, 0.0});
  const double y = std::max({low.y - p.y, p.y - high.y, 0.0});
  return x * x + y * y;
}

Feature common_ends(const Feature &a, const Feature &b) {
  return {b.has(a.from) ? a.from : none, b.has(a.to) ? a.to : none};
}

FeatureTree::FeatureTree(std::span<const Point> all_vertices, std::vector<Feature> all_features)
    : vertices(all_vertices.begin(), all_vertices.end()), features(std::move(all_features)) {
  order(0, features.size());
  leaves = std::bit_ceil(std::max<std::size_t>(1, features.size()));
  boxes.resize(2 * leaves);
  common.resize(2 * leaves, {none, none});
  std::ranges::copy(features, common.begin() + static_cast<std::ptrdiff_t>(leaves));
  for (std::size_t i = 0; i < features.size(); ++i)
    for (const LocalIndex end : {features[i].from, features[i].to})
      boxes[leaves + i].add(vertices[index(end)]);
  for (std::size_t node = leaves; node-- > 1;) {
    const std::size_t left = 2 * node, right = left + 1; // nothing is right without anything left
    boxes[node] = boxes[left];
    common[node] = common[left];
    if (boxes[right].is_empty())
      continue;
    boxes[node].add(boxes[right].low);
    boxes[node].add(boxes[right].high);
    common[node] = common_ends(common[left], common[right]);
  }
}

/// By the median of the longer extent of the middles.
void FeatureTree::order(std::size_t first, std::size_t last) {
  if (last - first < 2)
    return;
  const auto middle = [&](const Feature &f) {
    return between(vertices[index(f.from)], vertices[index(f.to)], 0.5);
  };
  Box box;
  for (std::size_t i = first; i < last; ++i)
    box.add(middle(features[i]));
  const bool by_x = box.high.x - box.low.x >= box.high.y - box.low.y;
  // The left subtree is full but for the last features.
  const std::size_t half = std::bit_ceil(last - first) / 2;
  const auto begin = features.begin() + static_cast<std::ptrdiff_t>(first);
  std::nth_element(begin, begin + static_cast<std::ptrdiff_t>(half),
                   features.begin() + static_cast<std::ptrdiff_t>(last),
                   [&](const Feature &a, const Feature &b) {
                     return by_x ? middle(a).x < middle(b).x : middle(a).y < middle(b).y;
                   });
  order(first, first + half);
  order(first + half, last);
}

double FeatureTree::squared_distance(Point p, std::size_t feature) const {
  const Point a = vertices[index(features[feature].from)], b = vertices[index(features[feature].to)];
  const Displacement along = b - a;
  const double length = squared_length(along);
  const double part = length > 0 ? std::clamp(dot(p - a, along) / length, 0.0, 1.0) : 0.0;
  return dovetail::squared_distance(p, a + part * along);
}

} // namespace dovetail
