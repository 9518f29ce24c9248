/// Planar domains: a straight-line graph that says what is to be meshed, and a mesh of it.
#pragma once

#include "dovetail/base/types.hpp"
#include "dovetail/mesh/triangulation.hpp"

#include <cstdint>
#include <vector>

namespace dovetail {

/// A straight constraint between two vertices.
struct Segment {
  LocalIndex from;
  LocalIndex to;
  std::int32_t marker = 0;
  friend constexpr bool operator==(const Segment &, const Segment &) = default;
};

/// A point of the plane inside a region, and what holds there.
struct RegionSeed {
  Point place;
  double attribute = 0;
  double max_area = 0; ///< of triangles in this region; 0: no limit of its own
};

/// A planar straight-line graph (PSLG) in order: vertices are distinct, no two segments have the same ends,
/// and segments meet each other and vertices at their ends only.
struct PlanarGraph {
  std::vector<Point> vertices;
  std::vector<std::int32_t> vertex_markers; ///< one a vertex
  std::vector<Segment> segments;
  /// Not 0: even_odd does not count this segment (a line inside a polygon, the border of two of them). One a
  /// segment, or none at all.
  std::vector<std::uint8_t> is_line;
  std::vector<Point> holes; ///< what can be reached from here without crossing a segment is outside
  std::vector<RegionSeed> regions;
  bool even_odd = false; ///< outside is also what an even number of segments separates from infinity
};

/// A constrained Delaunay triangulation of a domain, its outside and holes carved away. The vertices are
/// those of the graph, in its order, and behind them Steiner points.
struct DomainMesh {
  std::vector<Point> vertices;
  std::vector<std::int32_t> vertex_markers; ///< a Steiner point on a segment has the segment's
  Triangulation triangles;                  ///< neighbour `none`: outside
  /// Of side i of triangle t (across from its corner i) at [3t + i]: the segment of the graph that this edge
  /// is a piece of, or `none`. The same from both sides.
  std::vector<LocalIndex> segment_of_side;
  std::vector<std::int32_t> region; ///< one a triangle: the number of its seed in the graph, or `none`
};

} // namespace dovetail
