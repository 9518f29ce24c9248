#include "feature_tree.hpp"

#include "dovetail/geometry/constructions.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

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

double FeaturePart::squared_distance(Point p) const {
  const Displacement along = b - a;
  const double length = squared_length(along);
  const double fraction = length > 0 ? std::clamp(dot(p - a, along) / length, 0.0, 1.0) : 0.0;
  return dovetail::squared_distance(p, a + fraction * along);
}

namespace {

constexpr double most_parts = 4; // of a feature, on average, beside one

std::vector<FeaturePart> cut(std::span<const Point> vertices, std::span<const Feature> features) {
  const auto point = [&](LocalIndex v) { return vertices[index(v)]; };
  double total = 0;
  for (const Feature &f : features)
    total += distance(point(f.from), point(f.to));
  const double unit = total / most_parts / static_cast<double>(features.size());
  std::vector<FeaturePart> parts;
  for (const Feature &feature : features) {
    const Point from = point(feature.from), to = point(feature.to);
    const double pieces = unit > 0 ? std::max(1.0, std::ceil(distance(from, to) / unit)) : 1;
    Point a = from;
    for (double k = 1; k <= pieces; ++k) {
      const Point b = k < pieces ? between(from, to, k / pieces) : to;
      parts.push_back({a, b, feature});
      a = b;
    }
  }
  return parts;
}

} // namespace

FeatureTree::FeatureTree(std::span<const Point> vertices, std::span<const Feature> features)
    : parts(cut(vertices, features)), leaves(std::bit_ceil(std::max<std::size_t>(1, parts.size()))) {
  order(0, parts.size());
  boxes.resize(2 * leaves);
  common.resize(2 * leaves, {none, none});
  for (std::size_t i = 0; i < parts.size(); ++i) {
    boxes[leaves + i].add(parts[i].a);
    boxes[leaves + i].add(parts[i].b);
    common[leaves + i] = parts[i].feature;
  }
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
  const auto middle = [](const FeaturePart &part) { return between(part.a, part.b, 0.5); };
  Box box;
  for (std::size_t i = first; i < last; ++i)
    box.add(middle(parts[i]));
  const bool by_x = box.high.x - box.low.x >= box.high.y - box.low.y;
  // The left subtree is full but for the last parts.
  const std::size_t half = std::bit_ceil(last - first) / 2;
  const auto begin = parts.begin() + static_cast<std::ptrdiff_t>(first);
  std::nth_element(begin, begin + static_cast<std::ptrdiff_t>(half),
                   parts.begin() + static_cast<std::ptrdiff_t>(last),
                   [&](const FeaturePart &p, const FeaturePart &q) {
                     return by_x ? middle(p).x < middle(q).x : middle(p).y < middle(q).y;
                   });
  order(first, first + half);
  order(first + half, last);
}

} // namespace dovetail
