/// How fine a domain is by itself: the local feature size, and what it says of the number of triangles.
/// Local.
///
/// lfs(x) is the radius of the smallest disk at x that meets two vertices or segments of the graph that do
/// not touch each other (Ruppert, 1995). No mesh without small angles has fewer vertices than a constant
/// times the integral of 1 / lfs^2 over the domain, and Delaunay refinement makes no more than another
/// constant times it; so vertices over integral is a number that meshes of different domains can be compared
/// by.
#pragma once

#include "dovetail/base/progress.hpp"
#include "dovetail/mesh/domain.hpp"

#include <memory>
#include <span>

namespace dovetail {

struct FeatureTree;

/// Looks up local feature sizes in a tree over all features.
class FeatureSize {
public:
  /// Features are the segments, their ends, and the vertices `alone` that are input without having one.
  FeatureSize(std::span<const Point> vertices, std::span<const Segment> segments,
              std::span<const LocalIndex> alone);
  ~FeatureSize();
  FeatureSize(FeatureSize &&) noexcept;

  /// Infinite where there are no two such features. Rounded. Usually O(log n); more where many segments meet
  /// in the nearest vertex.
  double at(Point p) const;

private:
  std::unique_ptr<FeatureTree> tree_;
};

/// The integral of 1 / lfs^2 over all triangles, to better than one percent: every triangle is divided in
/// four until that changes its part by less than three percent, of which a fraction remains. Some dozen to
/// some hundred look-ups a triangle.
double integrate_feature_density(const DomainMesh &mesh, const FeatureSize &size,
                                 const Progress &progress = {});

} // namespace dovetail
