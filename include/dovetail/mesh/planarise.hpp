/// From segments as people draw them to a planar straight-line graph in order. Local.
///
/// Equal vertices become one; a segment that passes through a vertex is divided there; where segments cross,
/// both get a new vertex, the exact crossing rounded to the nearest doubles (geometry/intersection.hpp);
/// pieces that lie on each other become one segment. So every segment given becomes a *chain* of vertices.
///
/// A rounded crossing leaves the segments by a rounding error, and their chains bend there. The rule is that
/// a bend sweeps nothing: of the vertices that are given, none may come to lie on the other side of a chain.
/// To that end the vertices in the triangle between a piece and its bend are looked up (exactly), and if
/// there are any, the chain goes around them instead, through those that hold it like a string. What the bent
/// pieces now cross or touch is divided again, until nothing is left. Chains stay within the bounding boxes
/// of their segments and are monotone in the segment's longer direction. The idea of pulling segments to
/// vertices nearby is that of snap rounding (Hobby, Practical segment intersection with finite precision
/// output, 1999), here without a grid.
#pragma once

#include "dovetail/mesh/domain.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace dovetail {

/// Vertices and segments in any condition; coordinates are finite.
struct SegmentSet {
  std::vector<Point> vertices;
  std::vector<std::int32_t> vertex_markers; ///< one a vertex, or none at all
  std::vector<Segment> segments;            ///< their ends must be vertices
  std::vector<std::uint8_t> is_line; ///< one a segment, or none at all: not part of an outline for even_odd
  std::vector<Point> holes;
  std::vector<RegionSeed> regions;
  bool even_odd = false;
};

/// How often something had to be mended, or is unusual.
struct PlanarRepairs {
  GlobalIndex duplicate_vertices = 0;   ///< equal to a vertex before them
  GlobalIndex zero_length = 0;          ///< segments whose ends are equal
  GlobalIndex repeated = 0;             ///< segments with the ends of one before them
  GlobalIndex overlapping = 0;          ///< other segments that share a piece with one before them
  GlobalIndex junctions = 0;            ///< times that a segment passes through the end of another
  GlobalIndex vertices_on_segments = 0; ///< times that one passes through a vertex without segments
  GlobalIndex crossings = 0;            ///< pairs of segments, or of their pieces, that got a common vertex
  GlobalIndex pulled = 0;               ///< vertices that a chain goes through so as not to sweep them
  GlobalIndex hanging_ends = 0;         ///< vertices with one segment: lines that end, outlines not closed
  GlobalIndex lone_vertices = 0;        ///< without segments
};

/// Two segments that cross.
struct SegmentCrossing {
  LocalIndex first, second; ///< as numbered in the SegmentSet, first < second
  Point place;              ///< rounded
};

enum class CrossingRule : std::uint8_t { split, refuse };

struct Planarised {
  /// Its vertices are the distinct ones given, in their order, and behind them the crossings.
  PlanarGraph graph;
  std::vector<LocalIndex> vertex_of_input; ///< of every vertex given: the graph's
  LocalIndex given_vertices = 0;           ///< vertices of the graph that are not crossings
  /// Segment i given is the chain chain_vertices[chain_offsets[i]] .. [chain_offsets[i + 1] - 1] from its
  /// `from` to its `to`: one vertex, if these are equal. Consecutive ones are the ends of a segment of the
  /// graph.
  std::vector<LocalIndex> chain_offsets;
  std::vector<LocalIndex> chain_vertices;
  PlanarRepairs repairs;
  /// CrossingRule::refuse: crossing segments, of all pairs that with the lowest numbers; the rest is not
  /// valid.
  std::optional<SegmentCrossing> refused;
};

/// A segment of the graph has the marker of the first segment with one that it is a piece of, a vertex that
/// of the first equal vertex with one. Holes, regions and even_odd are passed on.
/// Errors (input): segments that name no vertex; segments so close together that rounding creates new
/// crossings again and again. Expected O((n + k) log n) for n segments in k pieces.
Planarised planarise(const SegmentSet &given, CrossingRule crossings = CrossingRule::split);

} // namespace dovetail
