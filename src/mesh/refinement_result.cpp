#include "refinement.hpp"

#include "dovetail/base/huge_pages.hpp"

#include <algorithm>
#include <cassert>

namespace dovetail {
namespace {

constexpr std::size_t index(LocalIndex i) { return static_cast<std::size_t>(i); }

} // namespace

/// Two of its corners are on segments: in most meshes few triangles are like that.
bool Refinement::may_be_exempt(const Face &face) const {
  return std::ranges::count_if(face.corner,
                               [&](LocalIndex v) { return segment_of_vertex_[index(v)] != none; }) >= 2;
}

/// Unless points ran out, what is bad was met in the end and is left or exempt.
std::vector<LeftTriangle> Refinement::triangles_left() const {
  std::vector<LeftTriangle> result;
  const bool any_exempt = !small_angles_.none_at_all();
  if (!full_ && left_triangles_.empty() && !any_exempt)
    return result;
  for (LocalIndex t = 0; t < faces_.count(); ++t) {
    const Face &face = faces_.face(t);
    if (!full_ && !(any_exempt && may_be_exempt(face)) && !left_triangles_.contains(t))
      continue;
    const Shape shape = shape_of(face);
    if (!bound_.is_below(shape.sides) && !is_too_large(t, shape))
      continue;
    LeftReason reason = LeftReason::small_input_angle;
    if (is_bad(t, shape)) {
      const auto left = left_triangles_.find(t);
      const bool known = left != left_triangles_.end() && left->second.corner == face.corner;
      assert(known || full_);
      reason = known ? left->second.reason : LeftReason::max_points;
    }
    result.push_back({t, barycentre(shape.a, shape.b, shape.c), reason,
                      smallest_angle(shape.a, shape.b, shape.c), shape.area});
  }
  return result;
}

std::vector<LeftSubsegment> Refinement::subsegments_left() const {
  std::vector<LeftSubsegment> result;
  if (left_segments_.empty())
    return result;
  for (LocalIndex t = 0; t < faces_.count(); ++t)
    for (HalfEdge h = 4 * t; h < 4 * t + 3; ++h)
      if (faces_.is_segment(h) && h > faces_.twin(h))
        if (const auto reason = left_reason(h))
          result.push_back({given_or_new(faces_.from(h)), given_or_new(faces_.to(h)), *reason});
  return result;
}

/// With the given vertices under their given numbers again.
Refined Refinement::result() {
  Refined result;
  result.left_triangles = triangles_left();
  result.left_subsegments = subsegments_left();

  const std::size_t given = given_number_.size();
  result.mesh.vertex_markers = std::move(given_markers_);
  reserve_huge(result.mesh.vertex_markers, vertices_.size());
  result.mesh.vertex_markers.resize(given, 0);
  for (std::size_t v = given; v < vertices_.size(); ++v) {
    const LocalIndex segment = segment_of_vertex_[v];
    ++(segment == none ? result.points_inside : result.points_on_segments);
    result.mesh.vertex_markers.push_back(segment == none ? 0 : segments_[index(segment)].marker);
  }
  for (Face &face : faces_.faces)
    for (LocalIndex &v : face.corner)
      v = given_or_new(v);
  collect_faces(faces_, result.mesh);
  const std::vector<Point> first(vertices_.begin(), vertices_.begin() + std::ssize(given_number_));
  result.mesh.vertices = std::move(vertices_);
  for (std::size_t v = 0; v < given; ++v)
    result.mesh.vertices[index(given_number_[v])] = first[v];
  return result;
}

} // namespace dovetail
