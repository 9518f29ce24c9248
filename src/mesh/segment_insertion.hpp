/// Forces segments into a constrained Delaunay triangulation, one after the other. Private to mesh.
#pragma once

#include "cavity_polygon.hpp"
#include "faces.hpp"

#include <span>
#include <vector>

namespace dovetail {

/// Finds the triangles that a segment crosses by walking along it, and triangulates what lies on either side
/// of it anew (cavity_polygon.hpp). All decisions are exact. A segment is looked for around both its ends in
/// turns, so that one end may have any number of edges.
class SegmentInsertion {
public:
  /// The faces are those of a constrained Delaunay triangulation of their vertices.
  SegmentInsertion(std::span<const Point> vertices, Faces &faces);

  /// If its ends are joined by an edge, that becomes the segment.
  bool insert_edge(const Segment &segment, LocalIndex number);
  /// An Error (input) if the segment meets another one, or a vertex, between its ends.
  void insert(const Segment &segment, LocalIndex number);

private:
  /// Where the straight way from one vertex to another leaves the triangles around the first.
  struct Departure {
    LocalIndex from, to;
    HalfEdge side;
    bool is_edge; ///< the side is the way itself, and not what it crosses first
  };
  /// An edge of the polygon around the crossed faces.
  struct Rim {
    HalfEdge inside;    ///< of a crossed face; later of the new one
    HalfEdge outside;   ///< none if that is a crossed face too
    LocalIndex partner; ///< the number of the same edge in the rim on its other side then, or none
    LocalIndex segment;
  };

  Departure depart(const Segment &segment, LocalIndex number) const;
  void mark_edge(HalfEdge h, LocalIndex number);
  void walk(const Departure &departure, LocalIndex number);
  void save_rim();
  HalfEdge fill(std::span<const LocalIndex> chain, std::span<Rim> rim, std::span<const LocalIndex> faces);
  void link_rim();
  Point point(LocalIndex v) const { return vertices_[static_cast<std::size_t>(v)]; }

  std::span<const Point> vertices_;
  Faces &faces_;
  std::vector<HalfEdge> across_; ///< from a vertex that is in a triangle, the opposite side of one

  CavityPolygon polygon_;
  std::vector<LocalIndex> crossed_;                ///< faces
  std::vector<LocalIndex> left_, right_;           ///< chains of vertices, beginning at the way's start
  std::vector<HalfEdge> left_sides_, right_sides_; ///< of crossed faces, along the chains
  std::vector<Rim> rim_;                           ///< the left chain's, then the right one's backwards
  std::vector<Point> points_;
};

} // namespace dovetail
