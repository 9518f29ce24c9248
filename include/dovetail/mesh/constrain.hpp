/// Constrained Delaunay triangulation of a planar straight-line graph (Chew, Constrained Delaunay
/// triangulations, 1989): every segment is an edge, and every other edge is locally Delaunay by the canonical
/// rule of in_circle. No other triangulation of the graph has this property, so the triangles are a function
/// of the graph as a set. Local; exact.
///
/// The Delaunay triangulation of the vertices comes first, then one missing segment after the other, each by
/// the triangles that it crosses (src/mesh/segment_insertion.hpp), then the outside and the holes are carved.
#pragma once

#include "dovetail/mesh/domain.hpp"

#include <cstdint>
#include <vector>

namespace dovetail {

/// What bounds the mesh.
enum class Outline : std::uint8_t {
  segments,    ///< outside is what is reached from beyond the convex hull without crossing a segment
  convex_hull, ///< nothing of the convex hull is outside but holes; its edges become segments
};

struct ConstrainOptions {
  Outline outline = Outline::segments;
  std::int32_t hull_marker =
      1; ///< of the segments that are made of hull edges, and of their ends without one
};

/// Why a seed had no effect.
enum class SeedFault : std::uint8_t {
  outside,    ///< there is no triangle there, or it was carved away
  on_segment, ///< of two sides it names none
  taken,      ///< a region that has a seed of lower number
};

struct StraySeed {
  LocalIndex seed; ///< number in the graph's holes or regions
  SeedFault fault;
};

struct Constrained {
  DomainMesh mesh;
  /// Made of hull edges (Outline::convex_hull), numbered behind those of the graph.
  std::vector<Segment> hull_segments;
  std::vector<StraySeed> stray_holes;
  std::vector<StraySeed> stray_regions;
  /// Triangles were there and all were carved away: no closed outline, or holes everywhere.
  bool nothing_left = false;
};

/// Vertices keep their numbers, also those that no triangle needs any more. Without triangles (fewer than
/// three vertices, or all on a line) the mesh is empty. The order of triangles depends on the order of the
/// graph.
/// An Error (input) names the segments and vertices of a graph that is not in order: crossing segments, a
/// vertex on a segment, a segment without length or beyond the vertices; equal vertices must not occur.
/// Expected O(n log n) for n vertices, and O(k) for a segment that crosses k triangles.
Constrained constrain(const PlanarGraph &graph, const ConstrainOptions &options = {});

} // namespace dovetail
