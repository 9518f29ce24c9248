/// How a Steiner point gets into a constrained Delaunay triangulation: its cavity is found, which changes
/// nothing, and committed if the finder likes it. Private to mesh.
///
/// The cavity of a point are the triangles whose circles hold it, as far as it sees them; the fan between the
/// point and the cavity's rim takes their place (Bowyer and Watson, 1981, with segments as walls). Nothing is
/// located: the point is made from a triangle whose circle holds it, or from a subsegment.
#pragma once

#include "dovetail/geometry/seen.hpp"
#include "faces.hpp"

#include <vector>

namespace dovetail {

/// An edge of the rim, with the cavity on its left; it ends where the next one begins.
struct RimEdge {
  HalfEdge inside;    ///< of a face of the cavity
  HalfEdge outside;   ///< none on the boundary
  LocalIndex segment; ///< or none
  LocalIndex from;
  Point from_point;
  double squared_distance; ///< of from_point from the new point
  double doubled_area;     ///< of the triangle between the edge and the new point
};

/// A half of a cavity on a segment is open: its rim goes from one end of the subsegment to the other.
struct SteinerCavity {
  std::vector<LocalIndex> faces; ///< of the cavity; once committed, fan triangle k is in the place k
  /// Counter-clockwise as seen from the point; behind the last edge, as one that is none, where it ends.
  std::vector<RimEdge> rim;
  bool open = false;
  bool locked = false;       ///< a face has a locked side
  LocalIndex segment = none; ///< on which the point of an open one lies

  std::size_t edge_count() const { return rim.empty() ? 0 : rim.size() - 1; }
};

/// Finds cavities; keeps memory between calls.
class CavitySearch {
public:
  CavitySearch(const std::vector<Point> &vertices, const Faces &faces) : vertices_(vertices), faces_(faces) {}

  /// From a face whose circle is to hold p. False, and no cavity, if it does not.
  bool find(LocalIndex face, Point p, SteinerCavity &cavity);
  /// The half left of a subsegment, of a point of the subsegment or near it. False, and no cavity, if the
  /// circle of its face does not hold p.
  bool find_half(HalfEdge subsegment, Point p, SteinerCavity &cavity);

private:
  /// An edge of the rim as far as it is known; it begins where the one before ends.
  struct Edge {
    HalfEdge inside;
    SeenAlone to;
    double cross; ///< of its ends
  };

  bool begin(HalfEdge first, Point p);
  bool in_conflict(HalfEdge h, Point p, const SeenAlone &from, const Edge &edge, const SeenAlone &tip,
                   double from_cross_tip, double tip_cross_to) const;
  void dig(Point p, SteinerCavity &cavity);
  Point point(LocalIndex v) const { return vertices_[static_cast<std::size_t>(v)]; }
  SeenAlone see(LocalIndex v, Point p) const { return see_alone(point(v), p); }

  const std::vector<Point> &vertices_;
  const Faces &faces_;
  SeenAlone from_;           ///< where the edge on top begins
  std::vector<Edge> to_dig_; ///< the next in counter-clockwise order on top
};

/// Replaces the cavity by the fan around a vertex. Faces that are free are the cavity's, then new ones.
void commit(SteinerCavity &cavity, LocalIndex vertex, Faces &faces);
/// Both halves on a subsegment, the left one first; the right one is without rim at the boundary.
void commit_halves(SteinerCavity &left, SteinerCavity &right, LocalIndex vertex, Faces &faces);

} // namespace dovetail
