/// One run of Ruppert's algorithm (mesh/refine.hpp). Private to mesh.
///
/// Everything that is changed passes through two functions, insert_inside and split: a point is made, its
/// cavity found, looked at, and committed or left. The fan around the new point is then looked at for
/// encroached subsegments and skinny triangles, which wait in two queues, the subsegments first. Entries are
/// never taken out when what they name goes: they are recognised as stale when their turn comes.
#pragma once

#include "dovetail/mesh/quality.hpp"
#include "dovetail/mesh/refine.hpp"
#include "faces.hpp"
#include "size_field.hpp"
#include "skinny_queue.hpp"
#include "steiner_cavity.hpp"
#include "tiles.hpp"

#include <optional>
#include <unordered_map>
#include <vector>

namespace dovetail {

class Refinement {
public:
  /// size_field: or nullptr. The growth among the options is not looked at.
  Refinement(DomainMesh mesh, std::span<const Segment> segments, const RefineOptions &options,
             const SizeField *size_field);
  void run();
  /// Once, after run.
  Refined result();

private:
  /// What decides whether a triangle is bad.
  struct Shape {
    Point a, b, c;
    SquaredSides sides;
    double area;
  };
  /// A piece of a segment as it was, with the triangle on its left that gave reason to split it.
  struct Subsegment {
    HalfEdge side;
    LocalIndex from, to;
    SkinnyQueue::Tile tile;
  };
  struct Left {
    std::array<LocalIndex, 3> corner; ///< the face is still the same if it has these
    LeftReason reason;
  };

  std::vector<LeftTriangle> triangles_left() const;
  bool may_be_exempt(const Face &face) const;
  std::vector<LeftSubsegment> subsegments_left() const;
  LocalIndex given_or_new(LocalIndex v) const {
    return static_cast<std::size_t>(v) < given_number_.size() ? given_number_[static_cast<std::size_t>(v)]
                                                              : v;
  }

  void number_vertices(const DomainMesh &mesh);
  void lock(const std::function<bool(LocalIndex, int)> &locked);
  bool try_again();
  void look_at_all();
  /// The cavity, now the fan around the vertex at p.
  void look_at_fan(const SteinerCavity &cavity, Point p);
  void look_at_subsegment(HalfEdge h);
  void look_at_triangle(LocalIndex t, const Shape &shape, SkinnyQueue::Tile tile);

  void split_encroached();
  void split(HalfEdge h);
  std::optional<Point> split_point(HalfEdge h) const;
  bool fits(HalfEdge h, Point p) const;
  void insert_inside(const SkinnyQueue::Waiting &waiting);
  bool encroaches(Point p);
  LocalIndex add_vertex(Point p, LocalIndex segment);

  bool is_bad(LocalIndex t, const Shape &shape) const;
  bool is_exempt(LocalIndex t, std::size_t shortest) const;
  bool is_too_large(LocalIndex t, const Shape &shape) const;
  bool is_too_large_for_its_place(LocalIndex t, const Shape &shape) const;
  double least_squared_distance(const SteinerCavity &cavity) const;
  std::optional<LeftReason> too_near(double squared_distance) const;
  void leave(LocalIndex t, LeftReason reason);
  void leave_subsegment(HalfEdge h, LeftReason reason);
  std::optional<LeftReason> left_reason(HalfEdge h) const;

  Point point(LocalIndex v) const { return vertices_[static_cast<std::size_t>(v)]; }
  Shape shape_of(const Face &face) const {
    const Point a = point(face.corner[0]), b = point(face.corner[1]), c = point(face.corner[2]);
    return {a, b, c, squared_sides(a, b, c), 0.5 * doubled_area(a, b, c)};
  }

  const RefineOptions &options_;
  const SizeField *size_field_;
  std::span<const Segment> segments_;
  AngleBound bound_;
  double max_area_; ///< infinite: no limit
  SmallAngles small_angles_;
  double floor_ = 0; ///< squared distance that doubles still resolve

  std::vector<LocalIndex> given_number_; ///< of the vertices, which are numbered in the order of triangles
  std::vector<Point> vertices_;
  std::vector<LocalIndex> segment_of_vertex_; ///< as segments_of_vertices
  std::vector<std::int32_t> given_markers_;
  Faces faces_;

  std::vector<Subsegment> encroached_;
  Tiles tiles_;
  SkinnyQueue skinny_;
  SkinnyQueue::Tile tile_ = 0; ///< of what is being looked at, split or inserted into
  CavitySearch search_;
  SteinerCavity cavity_, right_cavity_;
  std::vector<Subsegment> blocking_;                    ///< subsegments that a point would encroach on
  std::unordered_map<LocalIndex, Left> left_triangles_; ///< by face
  std::unordered_map<std::uint64_t, LeftReason> left_segments_; ///< by both ends
  std::size_t tried_vertices_ = 0; ///< when what had been left was last tried again
  int tries_ = 0;
  bool full_ = false; ///< no more points
};

} // namespace dovetail
