#include "segment_insertion.hpp"

#include "dovetail/base/error.hpp"
#include "dovetail/geometry/predicates.hpp"

#include <algorithm>
#include <cassert>
#include <fmt/core.h>

namespace dovetail {
namespace {

constexpr std::size_t index(LocalIndex i) { return static_cast<std::size_t>(i); }

/// Twins that stand for a place in the list of rims, while both faces beside an edge are being replaced.
constexpr HalfEdge coded(std::size_t rim) { return -2 - static_cast<HalfEdge>(rim); }
constexpr bool is_coded(HalfEdge h) { return h <= -2; }
constexpr LocalIndex decoded(HalfEdge h) { return -2 - h; }

Error not_in_order(LocalIndex segment, std::string what) {
  return Error({ErrorKind::input, "segments", fmt::format("segment {}", segment), std::move(what),
                "segments may meet vertices and each other at their ends only: repair the graph"});
}

/// The triangles around a vertex one after another, each by its side across from the vertex: once around, or
/// from the first in both ways to the boundary.
class Star {
public:
  Star(const Faces &faces, HalfEdge across) : faces_(&faces), first_(across), at_(across) {}
  bool ended() const { return at_ == none; }
  HalfEdge across() const { return at_; }
  void advance() {
    if (counter_clockwise_) {
      const HalfEdge beyond = faces_->twin(next(at_));
      if (beyond != none) {
        at_ = next(beyond);
        if (at_ == first_)
          at_ = none;
        return;
      }
      counter_clockwise_ = false;
      at_ = first_;
    }
    const HalfEdge beyond = faces_->twin(previous(at_));
    at_ = beyond == none ? none : previous(beyond);
  }

private:
  const Faces *faces_;
  HalfEdge first_;
  HalfEdge at_;
  bool counter_clockwise_ = true;
};

} // namespace

SegmentInsertion::SegmentInsertion(std::span<const Point> vertices, Faces &faces)
    : vertices_(vertices), faces_(faces), across_(vertices.size(), none) {
  for (HalfEdge h = 0; h < 4 * faces.count(); h = h % 4 == 2 ? h + 2 : h + 1)
    across_[index(faces.apex(h))] = h;
}

bool SegmentInsertion::insert_edge(const Segment &segment, LocalIndex number) {
  const Departure departure = depart(segment, number);
  if (departure.is_edge)
    mark_edge(departure.side, number);
  return departure.is_edge;
}

void SegmentInsertion::insert(const Segment &segment, LocalIndex number) {
  const Departure departure = depart(segment, number);
  if (departure.is_edge)
    return mark_edge(departure.side, number);
  walk(departure, number);
  save_rim();
  const std::size_t left_faces = left_.size() - 2, left_edges = left_.size() - 1;
  const std::span<const LocalIndex> faces = crossed_;
  const std::span<Rim> rim = rim_;
  const HalfEdge left = fill(left_, rim.first(left_edges), faces.first(left_faces));
  const HalfEdge right = fill(right_, rim.subspan(left_edges), faces.subspan(left_faces));
  faces_.link(left, right);
  link_rim();
  mark_edge(left, number);
}

/// Looks around both ends in turns: the sum over all segments of the smaller degree of two ends is linear
/// (Chiba and Nishizeki, Arboricity and subgraph listing algorithms, 1985).
SegmentInsertion::Departure SegmentInsertion::depart(const Segment &segment, LocalIndex number) const {
  LocalIndex here = segment.from, there = segment.to;
  Star star(faces_, across_[index(here)]), other(faces_, across_[index(there)]);
  while (!star.ended() || !other.ended()) {
    if (!star.ended()) {
      const HalfEdge side = star.across();
      const LocalIndex p = faces_.from(side), q = faces_.to(side);
      if (p == there)
        return {here, there, previous(side), true};
      if (q == there)
        return {here, there, next(side), true};
      const Sign of_p = orientation(point(here), point(there), point(p));
      const Sign of_q = orientation(point(here), point(there), point(q));
      if (of_p == Sign::negative && of_q == Sign::positive)
        return {here, there, side, false};
      const bool ascends = lexicographically_less(point(here), point(there));
      for (const auto &[v, sign] : {std::pair{p, of_p}, std::pair{q, of_q}})
        if (sign == Sign::zero && ascends == lexicographically_less(point(here), point(v)))
          throw not_in_order(number, fmt::format("vertex {} lies on it", v));
      star.advance();
    }
    std::swap(star, other);
    std::swap(here, there);
  }
  throw Error({ErrorKind::fault, "segments", fmt::format("segment {}", number),
               "no triangle at its ends lies in its direction", ""});
}

void SegmentInsertion::mark_edge(HalfEdge h, LocalIndex number) {
  if (faces_.is_segment(h))
    throw not_in_order(number, fmt::format("segment {} has the same ends", faces_.segment(h)));
  faces_.set_segment(h, number);
  if (faces_.twin(h) != none)
    faces_.set_segment(faces_.twin(h), number);
}

/// Collects the crossed faces, and what bounds them:
///
///        left chain                 Each edge that is crossed runs from the right to the left; the apex
///       .---.----.                  beyond takes the place of its right or of its left end.
///      / \  |  / | \                .
/// from ----------------> to
///      \ /  | /  | /
///       .---'----.  right chain
void SegmentInsertion::walk(const Departure &departure, LocalIndex number) {
  const auto [from, to, first, is_edge] = departure;
  HalfEdge side = first;
  crossed_.assign(1, face_of(side));
  left_ = {from, faces_.to(side)};
  right_ = {from, faces_.from(side)};
  left_sides_.assign(1, next(side));
  right_sides_.assign(1, previous(side));
  while (true) {
    if (faces_.is_segment(side))
      throw not_in_order(number, fmt::format("segment {} crosses it", faces_.segment(side)));
    const HalfEdge beyond = faces_.twin(side);
    const LocalIndex apex = faces_.apex(beyond);
    crossed_.push_back(face_of(beyond));
    const Sign turn = apex == to ? Sign::zero : orientation(point(from), point(to), point(apex));
    if (apex != to && turn == Sign::zero)
      throw not_in_order(number, fmt::format("vertex {} lies on it", apex));
    if (turn != Sign::negative) {
      left_.push_back(apex);
      left_sides_.push_back(previous(beyond));
    }
    if (turn != Sign::positive) {
      right_.push_back(apex);
      right_sides_.push_back(next(beyond));
    }
    if (apex == to)
      break;
    side = turn == Sign::positive ? next(beyond) : previous(beyond);
  }
  // From the other end the right side is the left one.
  std::ranges::reverse(right_);
  std::ranges::reverse(right_sides_);
}

/// Remembers what is beyond the rim. Where that is a crossed face too, around the free end of an edge, the
/// edge is in the rim twice, and both are about to be replaced.
void SegmentInsertion::save_rim() {
  rim_.clear();
  for (const std::vector<HalfEdge> *sides : {&left_sides_, &right_sides_})
    for (const HalfEdge side : *sides)
      rim_.push_back({side, faces_.twin(side), none, faces_.segment(side)});
  for (std::size_t i = 0; i < rim_.size(); ++i)
    faces_.set_twin(rim_[i].inside, coded(i));
  for (Rim &rim : rim_)
    if (rim.outside != none && is_coded(faces_.twin(rim.outside)))
      rim.partner = decoded(faces_.twin(rim.outside));
}

/// Triangulates the polygon of a chain in the place of the given faces. Its half-edge at the segment.
HalfEdge SegmentInsertion::fill(std::span<const LocalIndex> chain, std::span<Rim> rim,
                                std::span<const LocalIndex> faces) {
  points_.clear();
  for (const LocalIndex v : chain)
    points_.push_back(point(v));
  polygon_.triangulate(points_);
  const auto in_faces = [&](LocalIndex h) { return h == none ? none : 4 * faces[index(h / 3)] + h % 3; };
  for (std::size_t t = 0; t < faces.size(); ++t) {
    Face &face = faces_.face(faces[t]);
    face.segment_sides = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      face.corner[i] = chain[index(polygon_.corners()[3 * t + i])];
      face.twin[i] = in_faces(polygon_.twins()[3 * t + i]);
      across_[index(face.corner[i])] = 4 * faces[t] + static_cast<HalfEdge>(i);
    }
  }
  for (std::size_t k = 0; k < rim.size(); ++k)
    rim[k].inside = in_faces(polygon_.edges()[k]);
  return in_faces(polygon_.edges().back());
}

void SegmentInsertion::link_rim() {
  for (const Rim &rim : rim_) {
    faces_.link(rim.inside, rim.partner == none ? rim.outside : rim_[index(rim.partner)].inside);
    if (rim.segment != none)
      faces_.set_segment(rim.inside, rim.segment);
  }
}

} // namespace dovetail
