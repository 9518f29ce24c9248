#include "refinement.hpp"

#include <algorithm>

namespace dovetail {
namespace {

constexpr std::size_t index(LocalIndex i) { return static_cast<std::size_t>(i); }

} // namespace

/// With the given vertices under their given numbers again.
Refined Refinement::result() {
  Refined result;
  const std::size_t given = given_number_.size();
  const auto number = [&](LocalIndex v) { return index(v) < given ? given_number_[index(v)] : v; };
  // Reasons belong to faces that are still what they were; compared before corners get other numbers.
  for (LocalIndex t = 0; t < faces_.count(); ++t) {
    const Face &face = faces_.face(t);
    const Point a = point(face.corner[0]), b = point(face.corner[1]), c = point(face.corner[2]);
    const SquaredSides sides = squared_sides(a, b, c);
    const std::size_t i = sides.shortest();
    const bool below = bound_.is_below(sides.side[i], sides.side[(i + 1) % 3], sides.side[(i + 2) % 3]);
    if (!below && !is_too_large(t))
      continue;
    LeftReason reason = LeftReason::small_input_angle;
    if (is_bad(t, sides)) {
      const auto left = left_triangles_.find(t);
      const bool known = left != left_triangles_.end() && left->second.corner == face.corner;
      reason = known ? left->second.reason : LeftReason::max_points;
    }
    const Point centre{a.x + ((b.x - a.x) + (c.x - a.x)) / 3, a.y + ((b.y - a.y) + (c.y - a.y)) / 3};
    result.left_triangles.push_back(
        {t, centre, reason, smallest_angle(a, b, c), 0.5 * doubled_area(a, b, c)});
  }
  for (LocalIndex t = 0; t < faces_.count(); ++t)
    for (HalfEdge h = 4 * t; h < 4 * t + 3; ++h)
      if (faces_.is_segment(h) && h > faces_.twin(h))
        if (const auto left = left_reason(h))
          result.left_subsegments.push_back({number(faces_.from(h)), number(faces_.to(h)), *left});
  for (std::size_t v = given; v < vertices_.size(); ++v)
    ++(segment_of_vertex_[v] == none ? result.points_inside : result.points_on_segments);

  result.mesh.vertices.resize(vertices_.size());
  result.mesh.vertex_markers = std::move(given_markers_);
  result.mesh.vertex_markers.resize(given, 0);
  for (std::size_t v = 0; v < vertices_.size(); ++v) {
    result.mesh.vertices[index(number(static_cast<LocalIndex>(v)))] = vertices_[v];
    if (v >= given)
      result.mesh.vertex_markers.push_back(
          segment_of_vertex_[v] == none ? 0 : segments_[index(segment_of_vertex_[v])].marker);
  }
  for (Face &face : faces_.faces)
    for (LocalIndex &v : face.corner)
      v = number(v);
  collect_faces(faces_, result.mesh);
  return result;
}

} // namespace dovetail
