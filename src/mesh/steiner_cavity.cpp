#include "steiner_cavity.hpp"

#include "dovetail/geometry/constructions.hpp"
#include "dovetail/geometry/predicates.hpp"

#include <cassert>

namespace dovetail {
namespace {

constexpr std::size_t index(LocalIndex i) { return static_cast<std::size_t>(i); }

} // namespace

/// Whether the circle of the face left of h holds p, by its corners as p sees them: those of the edge, which
/// may be that of the face beyond, and the tip.
inline bool CavitySearch::in_conflict(HalfEdge h, Point p, const SeenAlone &from, const Edge &edge,
                                      const SeenAlone &tip, double from_cross_tip,
                                      double tip_cross_to) const {
  const auto circle = filter::in_circle(from, edge.to, tip, edge.cross, from_cross_tip, tip_cross_to);
  if (std::fabs(circle.value) > circle.bound) [[likely]]
    return circle.value > 0;
  return in_circle(point(faces_.from(h)), point(faces_.to(h)), point(faces_.apex(h)), p) == Sign::positive;
}

/// The sides of the face left of `first`, of which that one comes last. False if the circle of the face does
/// not hold p.
bool CavitySearch::begin(HalfEdge first, Point p) {
  const SeenAlone from = see(faces_.from(first), p), to = see(faces_.to(first), p),
                  tip = see(faces_.apex(first), p);
  const double from_cross_to = cross(from, to), to_cross_tip = cross(to, tip),
               tip_cross_from = cross(tip, from);
  // As seen from beyond, the edge runs the other way.
  if (!in_conflict(first, p, to, {first, from, -from_cross_to}, tip, to_cross_tip, tip_cross_from))
    return false;
  from_ = to;
  to_dig_.assign({{first, to, from_cross_to},
                  {previous(first), from, tip_cross_from},
                  {next(first), tip, to_cross_tip}});
  return true;
}

bool CavitySearch::find(LocalIndex face, Point p, SteinerCavity &cavity) {
  if (!begin(4 * face + 2, p))
    return false;
  cavity.faces.assign(1, face);
  cavity.open = false;
  dig(p, cavity);
  cavity.rim.push_back(cavity.rim.front());
  return true;
}

bool CavitySearch::find_half(HalfEdge subsegment, Point p, SteinerCavity &cavity) {
  if (!begin(subsegment, p))
    return false;
  to_dig_.erase(to_dig_.begin());
  cavity.faces.assign(1, face_of(subsegment));
  cavity.open = true;
  cavity.segment = faces_.segment(subsegment);
  dig(p, cavity);
  const LocalIndex last = faces_.from(subsegment);
  cavity.rim.push_back({none, none, none, last, point(last), squared_distance(point(last), p), 0});
  return true;
}

/// From sides of the first face. The cavity is a tree of faces, so none is met twice.
void CavitySearch::dig(Point p, SteinerCavity &cavity) {
  cavity.rim.clear();
  const Face *const faces = faces_.faces.data();
  std::uint8_t locks = faces_.face(cavity.faces[0]).locked_sides;
  SeenAlone from = from_;
  while (!to_dig_.empty()) {
    Edge edge = to_dig_.back();
    to_dig_.pop_back();
    while (true) {
      const Face &face = faces[index(face_of(edge.inside))];
      const auto side = static_cast<unsigned>(face_side(edge.inside));
      const HalfEdge outside = face.twin[side];
      const bool is_segment = (face.segment_sides >> side & 1) != 0;
      if (!is_segment) {
        const Face &beyond = faces[index(face_of(outside))];
        const SeenAlone tip = see(beyond.corner[static_cast<unsigned>(face_side(outside))], p);
        const double from_cross_tip = cross(from, tip), tip_cross_to = cross(tip, edge.to);
        if (in_conflict(outside, p, from, edge, tip, from_cross_tip, tip_cross_to)) {
          cavity.faces.push_back(face_of(outside));
          locks |= beyond.locked_sides;
          to_dig_.push_back({previous(outside), edge.to, tip_cross_to});
          edge = {next(outside), tip, from_cross_tip};
          continue;
        }
      }
      const LocalIndex start = face.corner[side == 2 ? 0 : side + 1];
      cavity.rim.push_back({edge.inside, outside, is_segment ? faces_.segment(edge.inside) : none, start,
                            point(start), from.lift, edge.cross});
      from = edge.to;
      break;
    }
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
                     0,
                     0,
                     0};
    before = t;
    if (edge.segment != none)
      faces.set_segment(4 * t, edge.segment);
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
