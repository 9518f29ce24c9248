/// A tree over the features of a graph, for whoever asks what of it is near. Private to mesh.
#pragma once

#include "dovetail/mesh/domain.hpp"

#include <limits>
#include <span>
#include <vector>

namespace dovetail {

/// Empty at first.
struct Box {
  Point low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  Point high{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  void add(Point p);
  bool is_empty() const { return !(low.x <= high.x); }
  double squared_distance_from(Point p) const;
};

/// A segment, or a vertex: then both ends are the same.
struct Feature {
  LocalIndex from;
  LocalIndex to;
  friend constexpr bool operator==(const Feature &, const Feature &) = default;
  bool has(LocalIndex vertex) const { return from == vertex || to == vertex; }
  bool touches(const Feature &other) const { return has(other.from) || has(other.to); }
};

/// The ends of one that the other has, too, or `none`.
Feature common_ends(const Feature &a, const Feature &b);

/// A part of a feature: the boxes of long segments would be in each other's way.
struct FeaturePart {
  Point a, b;
  Feature feature;
  double squared_distance(Point p) const;
};

/// A binary tree of boxes over the parts of features, five a feature at most on average: node i has the
/// children 2 i and 2 i + 1. O(n log n) to build.
struct FeatureTree {
  std::vector<FeaturePart> parts; ///< of the leaf leaves + i; leaves behind the last one are empty
  std::vector<Box> boxes;         ///< from 1 on; those of leaves from `leaves` on
  /// By node: the two ends that all features below it have, or `none`.
  std::vector<Feature> common;
  std::size_t leaves = 1;

  FeatureTree(std::span<const Point> vertices, std::span<const Feature> features);

private:
  void order(std::size_t first, std::size_t last);
};

} // namespace dovetail
