/// Delaunay refinement: Steiner points until no triangle has a smaller angle, or is larger, than was asked
/// for. Local.
///
/// Ruppert's algorithm (A Delaunay refinement algorithm for quality 2-dimensional mesh generation, 1995) on
/// the constrained triangulation, as told by Shewchuk (Delaunay refinement algorithms for triangular mesh
/// generation, 2002). A subsegment is encroached if its diametral circle holds a vertex that it sees, and is
/// split; when none is, of the triangles that are skinny or too large the one with the shortest edge (nearly:
/// src/mesh/skinny_queue.hpp) gets a point at its off-center (Ungor, Off-centers: a new type of Steiner
/// points for computing size-optimal quality-guaranteed Delaunay triangulations, 2004), or, if that would
/// encroach on subsegments, these are split instead.
///
/// Small input angles (Ruppert; Shewchuk; Miller, Pav, Walkington, When and why Ruppert's algorithm works,
/// 2003; ... Delaunay refinement algorithms work, 2005). Call an input vertex *sharp* if two of its segments
/// make an angle below 60 degrees. The subsegments at a sharp vertex are split at distances from it that are
/// powers of two, so that their ends lie on common concentric shells and do not chase each other inwards.
/// A triangle below the angle bound is left as it is, and is a legitimate exception, if
///  (corner) its smallest angle lies at an input vertex and both sides there are pieces of segments: no mesh
///           of the domain is without it; or
///  (shell)  its shortest edge joins Steiner points on two segments that meet, in a sharp vertex, at an angle
///           below 60 degrees, at the same distance from there up to a thousandth of it.
/// `is_exempt` (mesh/quality.hpp) decides this from a mesh alone.
///
/// Rounding (include/dovetail/README.md). Steiner points are rounded; from then on they are exact, like all
/// vertices, and the mesh is constrained Delaunay by exact predicates. The point that splits a subsegment
/// need not lie on it, and the two pieces then bend. It is chosen so that nothing is swept by the bend: it
/// lies on the subsegment, or strictly inside one of the two triangles beside it, on the boundary never
/// outside; and no piece is shorter than a quarter of the subsegment. Where doubles offer no such point the
/// subsegment is left.
///
/// It always ends: no point is inserted nearer to a vertex than `min_edge` or, at the least, 2^-44 of the
/// greatest coordinate. Whether it ends long before that is proved up to 20.7 degrees (Ruppert), with the
/// exceptions above up to 26.45 (Miller, Pav, Walkington), and seen up to 33; see RefineOptions::max_points.
#pragma once

#include "dovetail/base/progress.hpp"
#include "dovetail/mesh/domain.hpp"

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

namespace dovetail {

inline constexpr double most_min_angle = 33;

struct RefineOptions {
  double min_angle = 26.45; ///< degrees, 0 (no bound) to most_min_angle
  double max_area = 0;      ///< 0: no limit
  /// Of region i of the graph, 0: no limit of its own; regions behind its end have none.
  std::vector<double> max_area_of_region = {};
  /// Size field, 0: none. The boundary, as fine as it is without this option, asks for triangles no larger
  /// than its pieces there; at distance d from a piece of length l an equilateral triangle of the same area
  /// may have edges of l + growth * d. The least over all pieces holds, at the barycentre of a triangle.
  double growth = 0;
  /// Vertices of the given mesh that are boundary to the size field though they have no segment. A piece
  /// there is as long as the shortest edge.
  std::vector<LocalIndex> lone_vertices = {};
  LocalIndex max_points = std::numeric_limits<LocalIndex>::max(); ///< vertices, those of the input included
  double min_edge = 0; ///< no new point is nearer than this to another vertex
  /// Whether the edge on this side of this triangle of the given mesh, inside it, is locked: no triangle that
  /// has a locked edge is changed, and what would need that waits. Empty: none is.
  std::function<bool(LocalIndex triangle, int side)> locked = {};
  Progress progress = {};
};

/// Why a triangle that is too large, or below the angle bound, was left.
enum class LeftReason : std::uint8_t {
  small_input_angle, ///< a legitimate exception, as stated above; only the angle bound is not met
  precision,         ///< doubles have no room for another point there
  min_edge,          ///< RefineOptions::min_edge
  max_points,        ///< RefineOptions::max_points, or no more indices
  locked,            ///< waits for a locked edge
};
inline constexpr std::size_t left_reasons = 5;

struct LeftTriangle {
  LocalIndex triangle; ///< in the result
  Point place;         ///< its barycentre
  LeftReason reason;
  double angle; ///< its smallest, degrees
  double area;
};

/// A subsegment that was to be split, for a vertex in its diametral circle or a point that was to be inserted
/// there, and was left.
struct LeftSubsegment {
  LocalIndex from;
  LocalIndex to;
  LeftReason reason;
};

struct Refined {
  DomainMesh mesh;                              ///< vertices of the given mesh first, in their order
  std::vector<LeftTriangle> left_triangles;     ///< in order of triangles
  std::vector<LeftSubsegment> left_subsegments; ///< each once
  LocalIndex points_inside = 0;                 ///< Steiner points of this run inside the domain
  LocalIndex points_on_segments = 0;            ///< and on segments
};

/// Refines a constrained Delaunay triangulation, for example what `constrain` or `refine` gave. `segments`:
/// those that segment_of_side counts, the graph's and behind them Constrained::hull_segments. A segment may
/// come in pieces already; what lies on it between its ends counts as Steiner points.
/// Errors: usage for options out of range; input for coordinates all below 2^-900, or partly beyond 2^200 (or
/// all below 2^-200) and so different that no power of two brings them to about one. Expected O(n log n) for
/// n vertices of the result; memory for the result twice.
Refined refine(DomainMesh mesh, std::span<const Segment> segments, const RefineOptions &options = {});

} // namespace dovetail
