/// What a stored mesh of a domain says beyond its triangles.
#pragma once

#include "dovetail/mesh/domain.hpp"

#include <cstdint>
#include <vector>

namespace dovetail {

/// The domain that a mesh of one slab is a mesh of. Vertices are the slab's. Their markers are its attribute
/// "marker". Their input indices: the numbers of those given; behind them crossings of segments; behind those
/// Steiner points.
struct DomainRecord {
  std::vector<Segment> segments;     ///< the graph's, and behind them those made of hull edges
  GlobalIndex hull_segments = 0;     ///< how many were made of hull edges
  std::vector<std::uint8_t> is_line; ///< as in PlanarGraph: one for each segment of the graph, or none at all
  std::vector<Point> holes;
  std::vector<RegionSeed> regions;
  bool even_odd = false;
  std::vector<LocalIndex> segment_of_side; ///< three a triangle, as in DomainMesh
  std::vector<std::int32_t> region;        ///< one a triangle, as in DomainMesh
  /// Segments given, as chains of ends of segments of the graph (mesh/planarise.hpp).
  std::vector<LocalIndex> chain_offsets{0};
  std::vector<LocalIndex> chain_vertices;
  GlobalIndex given_vertices = 0; ///< in the input, those merged included
  double min_angle = 0;           ///< degrees that the mesh was refined to, 0: was not
  /// Triangles below that which are no exception by mesh/refine.hpp: limits or rounding stopped the
  /// refinement there, and it said so.
  std::vector<LocalIndex> left_triangles;
};

} // namespace dovetail
