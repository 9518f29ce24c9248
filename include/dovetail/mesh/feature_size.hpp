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
#include <optional>
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

  /// Infinite where there are no two such features. Rounded. Usually O(log n).
  double at(Point p) const;

private:
  std::unique_ptr<FeatureTree> tree_;
};

/// The integral of 1 / lfs^2 over all triangles, to better than one percent: where quarters of a triangle
/// tell most of what the whole did not, it is halved across its longest side, until quarters change five
/// percent of the integral, of which a fraction remains. Fifteen look-ups a triangle, and thirty for every
/// halving. Nothing where features are below what doubles resolve, or 20 halvings a triangle (or 10,000, if
/// that is more) were not enough.
std::optional<double> integrate_feature_density(const DomainMesh &mesh, const FeatureSize &size,
                                                const Progress &progress = {});

} // namespace dovetail
