/// How large triangles may be, by their distance from the boundary. Private to mesh.
#pragma once

#include "dovetail/mesh/domain.hpp"
#include "feature_tree.hpp"

#include <span>
#include <vector>

namespace dovetail {

/// The boundary of a mesh are the pieces of segments that are its edges, and vertices `alone`. Every piece
/// asks for edges as long as it is itself, a vertex for edges as long as its shortest, and at distance d from
/// there for edges longer by growth * d; at every place the least of these holds.
class SizeField {
public:
  /// growth > 0. O(n log n).
  SizeField(const DomainMesh &mesh, std::span<const LocalIndex> alone, double growth);

  /// Whether edges at p are to be shorter than this. Usually O(log n). Rounded.
  bool forbids(Point p, double length) const;

private:
  FeatureTree tree_;
  double growth_;
  std::vector<double> least_size_; ///< that a feature below a node of the tree asks for
};

} // namespace dovetail
