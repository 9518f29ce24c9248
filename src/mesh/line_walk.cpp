#include "dovetail/mesh/line_walk.hpp"

#include "dovetail/geometry/predicates.hpp"
#include "dovetail/mesh/locate.hpp"
#include "dovetail/mesh/star.hpp"

namespace dovetail {
namespace {

/// Where the segment is at the moment; the part behind has been dealt with.
struct Position {
  enum class Kind {
    entering, ///< about to go through the interior of the triangle of `at`
    vertex,   ///< at the apex of `at`
    end,
  } kind;
  HalfEdge at = none;
};

class LineWalk {
public:
  LineWalk(std::span<const Point> sites, const Triangulation &mesh, Point from, Point to)
      : sites_(sites), mesh_(mesh), from_(from), to_(to) {}

  std::vector<LocalIndex> run(LocalIndex hint) {
    Position now = begin(hint);
    while (now.kind != Position::Kind::end) {
      if (now.kind == Position::Kind::vertex) {
        now = leave_vertex(now.at);
      } else {
        triangles_.push_back(triangle_of(now.at));
        now = leave_triangle(triangle_of(now.at));
      }
    }
    return std::move(triangles_);
  }

private:
  static constexpr Position end{Position::Kind::end};
  static Position entering(HalfEdge h) { return h == none ? end : Position{Position::Kind::entering, h}; }
  static Position at_vertex(HalfEdge h) { return {Position::Kind::vertex, h}; }

  Point site(LocalIndex vertex) const { return sites_[position(vertex)]; }
  Sign side_of_line(LocalIndex vertex) const { return orientation(from_, to_, site(vertex)); }
  Sign side_of_edge(HalfEdge h) const {
    return orientation(site(origin(mesh_, h)), site(target(mesh_, h)), to_);
  }

  /// Of points on the line: does the segment reach beyond p, strictly?
  bool goes_beyond(Point p) const {
    return lexicographically_less(from_, to_) ? lexicographically_less(p, to_)
                                              : lexicographically_less(to_, p);
  }
  /// Is p, on the line, ahead of a point on it?
  bool is_ahead(Point p, Point of) const {
    return lexicographically_less(from_, to_) ? lexicographically_less(of, p) : lexicographically_less(p, of);
  }

  Position begin(LocalIndex hint) const {
    const Place place = locate(sites_, mesh_, from_, hint);
    const HalfEdge h = half_edge(place.triangle, place.side);
    switch (place.kind) {
    case PlaceKind::inside:
      return entering(h);
    case PlaceKind::vertex:
      return at_vertex(h);
    case PlaceKind::edge:
      return leave_edge(h);
    case PlaceKind::outside:
      return enter_hull(h);
    case PlaceKind::blocked:
      break; // nothing is locked
    }
    return end;
  }

  /// From inside an edge.
  Position leave_edge(HalfEdge h) const {
    const Sign side = from_ == to_ ? Sign::zero : side_of_edge(h);
    if (side != Sign::zero)
      return entering(side == Sign::positive ? h : twin(mesh_, h));
    for (const HalfEdge corner : {after(h), before(h)}) // whose apexes are the ends of the edge
      if (const Point tip = site(apex(mesh_, corner)); is_ahead(tip, from_) && goes_beyond(tip))
        return at_vertex(corner);
    return end;
  }

  /// From outside: which of the hull edges that are seen is met? One has its beginning on the left of the
  /// line and its end on the right; or the line goes through a vertex between two.
  Position enter_hull(HalfEdge seen) const {
    const auto sees = [&](HalfEdge h) {
      return orientation(site(origin(mesh_, h)), site(target(mesh_, h)), from_) == Sign::negative;
    };
    for (HalfEdge h = hull_before(mesh_, seen); sees(h); h = hull_before(mesh_, seen))
      seen = h;
    for (HalfEdge h = seen;; h = hull_after(mesh_, h)) {
      const bool is_seen = sees(h);
      const LocalIndex begin = origin(mesh_, h);
      const Sign of_begin = side_of_line(begin);
      if (of_begin == Sign::zero)
        return is_ahead(site(begin), from_) && goes_beyond(site(begin)) ? at_vertex(after(h)) : end;
      if (!is_seen)
        return end;
      if (of_begin == Sign::positive && side_of_line(target(mesh_, h)) == Sign::negative)
        return side_of_edge(h) == Sign::positive ? entering(h) : end;
    }
  }

  /// Through the side that begins on the right of the line and ends on the left, or the corner between such
  /// ends.
  Position leave_triangle(LocalIndex triangle) const {
    for (int i = 0; i < 3; ++i) {
      const HalfEdge h = half_edge(triangle, i);
      if (from_ == to_ || side_of_line(origin(mesh_, h)) != Sign::negative)
        continue;
      const Sign of_target = side_of_line(target(mesh_, h));
      if (of_target == Sign::positive)
        return side_of_edge(h) == Sign::negative ? entering(twin(mesh_, h)) : end;
      if (of_target == Sign::zero && side_of_line(apex(mesh_, h)) == Sign::positive)
        return goes_beyond(site(target(mesh_, h))) ? at_vertex(before(h)) : end;
    }
    return end;
  }

  /// Into the triangle of the star that has the end between its sides, or along one of these.
  Position leave_vertex(HalfEdge h) const {
    const Point here = site(apex(mesh_, h));
    if (!goes_beyond(here))
      return end;
    Star star;
    find_star(mesh_, h, star);
    for (const HalfEdge across : star.link) {
      const Point first = site(origin(mesh_, across)), second = site(target(mesh_, across));
      const Sign of_first = orientation(here, first, to_), of_second = orientation(here, second, to_);
      if (of_first == Sign::zero && is_ahead(first, here))
        return goes_beyond(first) ? at_vertex(after(across)) : end;
      if (of_second == Sign::zero && is_ahead(second, here))
        return goes_beyond(second) ? at_vertex(before(across)) : end;
      if (of_first == Sign::positive && of_second == Sign::negative)
        return entering(across);
    }
    return end;
  }

  std::span<const Point> sites_;
  const Triangulation &mesh_;
  Point from_;
  Point to_;
  std::vector<LocalIndex> triangles_;
};

} // namespace

std::vector<LocalIndex> triangles_along(std::span<const Point> sites, const Triangulation &mesh, Point from,
                                        Point to, LocalIndex hint) {
  return LineWalk(sites, mesh, from, to).run(hint);
}

} // namespace dovetail
