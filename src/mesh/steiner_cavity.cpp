#include "steiner_cavity.hpp"

#include "dovetail/geometry/constructions.hpp"
#include "dovetail/geometry/predicates.hpp"

#include <cassert>

namespace dovetail {
namespace {

constexpr std::size_t index(LocalIndex i) { return static_cast<std::size_t>(i); }

} // namespace

bool CavitySearch::in_conflict(const Face &face, Point p) const {
  return in_circle(point(face.corner[0]), point(face.corner[1]), point(face.corner[2]), p) == Sign::positive;
}

bool CavitySearch::find(LocalIndex face, Point p, SteinerCavity &cavity) {
  if (!in_conflict(faces_.face(face), p))
    return false;
  cavity.faces.assign(1, face);
  cavity.open = false;
  to_dig_.assign({4 * face + 2, 4 * face + 1, 4 * face});
  dig(p, cavity);
  cavity.rim.push_back(cavity.rim.front());
  return true;
}

bool CavitySearch::find_half(HalfEdge subsegment, Point p, SteinerCavity &cavity) {
  if (!in_conflict(faces_.face(face_of(subsegment)), p))
    return false;
  cavity.faces.assign(1, face_of(subsegment));
  cavity.open = true;
  cavity.segment = faces_.segment(subsegment);
  to_dig_.assign({previous(subsegment), next(subsegment)});
  dig(p, cavity);
  const LocalIndex last = faces_.from(subsegment);
  cavity.rim.push_back({none, none, none, last, point(last), squared_distance(point(last), p)});
  return true;
}

/// From sides of the first face, the next in counter-clockwise order on top. The cavity is a tree of faces,
/// so none is met twice.
void CavitySearch::dig(Point p, SteinerCavity &cavity) {
  cavity.rim.clear();
  const Face *const faces = faces_.faces.data();
  const Point *const vertices = vertices_.data();
  std::uint8_t locks = faces_.face(cavity.faces[0]).locked_sides;
  while (!to_dig_.empty()) {
    const HalfEdge inside = to_dig_.back();
    to_dig_.pop_back();
    const Face &face = faces[index(face_of(inside))];
    const auto side = static_cast<unsigned>(face_side(inside));
    const HalfEdge outside = face.twin[side];
    const bool is_segment = (face.segment_sides >> side & 1) != 0;
    if (!is_segment) {
      const Face &beyond = faces[index(face_of(outside))];
      if (in_conflict(beyond, p)) {
        cavity.faces.push_back(face_of(outside));
        locks |= beyond.locked_sides;
        to_dig_.push_back(previous(outside));
        to_dig_.push_back(next(outside));
        continue;
      }
    }
    const LocalIndex from = face.corner[side == 2 ? 0 : side + 1];
    const Point at = vertices[index(from)];
    cavity.rim.push_back(
        {inside, outside, is_segment ? faces_.segment(inside) : none, from, at, squared_distance(at, p)});
  }
  cavity.locked = locks != 0;
}

namespace {

/// Fan triangle k has the vertex as corner 0 and edge k of the rim across; the fan is closed in itself, or
/// open with its outer sides not linked.
void build_fan(SteinerCavity &cavity, LocalIndex vertex, Faces &faces) {
  const std::size_t count = cavity.edge_count();
  const std::int32_t region = faces.face(cavity.faces[0]).region;
  while (cavity.faces.size() < count)
    cavity.faces.push_back(faces.add());
  LocalIndex before = cavity.faces[count - 1];
  for (std::size_t k = 0; k < count; ++k) {
    const RimEdge &edge = cavity.rim[k];
    const LocalIndex t = cavity.faces[k];
    const LocalIndex after = cavity.faces[k + 1 < count ? k + 1 : 0];
    faces.face(t) = {{vertex, edge.from, cavity.rim[k + 1].from},
                     {edge.outside, 4 * after + 2, 4 * before + 1},
                     region,
                     static_cast<std::uint8_t>(edge.segment != none ? 1 : 0),
                     0,
                     0};
    before = t;
    if (edge.segment != none)
      faces.segment_of[index(4 * t)] = edge.segment;
    if (edge.outside != none)
      faces.set_twin(edge.outside, 4 * t);
  }
}

} // namespace

void commit(SteinerCavity &cavity, LocalIndex vertex, Faces &faces) {
  assert(cavity.edge_count() == cavity.faces.size() + 2);
  build_fan(cavity, vertex, faces);
}

void commit_halves(SteinerCavity &left, SteinerCavity &right, LocalIndex vertex, Faces &faces) {
  build_fan(left, vertex, faces);
  const HalfEdge left_first = 4 * left.faces.front() + 2, left_last = 4 * left.faces.back() + 1;
  HalfEdge right_first = none, right_last = none;
  if (!right.rim.empty()) {
    build_fan(right, vertex, faces);
    right_first = 4 * right.faces.front() + 2;
    right_last = 4 * right.faces.back() + 1;
  }
  faces.link(left_first, right_last);
  faces.link(left_last, right_first);
  for (const HalfEdge h : {left_first, left_last, right_first, right_last})
    if (h != none)
      faces.set_segment(h, left.segment);
}

} // namespace dovetail
