#include "polygon_triangulation.hpp"

#include "dovetail/geometry/predicates.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <utility>

namespace dovetail {
namespace {

std::size_t index(LocalIndex i) { return static_cast<std::size_t>(i); }

LocalIndex next(LocalIndex h) { return h % 3 == 2 ? h - 2 : h + 1; }
LocalIndex previous(LocalIndex h) { return h % 3 == 0 ? h + 2 : h - 1; }

/// splitmix64.
class Random {
public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::size_t below(std::size_t bound) {
    std::uint64_t v = state_ += 0x9e3779b97f4a7c15U;
    v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9U;
    v = (v ^ (v >> 27)) * 0x94d049bb133111ebU;
    return (v ^ (v >> 31)) % bound;
  }

private:
  std::uint64_t state_;
};

bool lies_between(Point p, Point a, Point b) {
  return lexicographically_less(a, b) ? lexicographically_less(a, p) && lexicographically_less(p, b)
                                      : lexicographically_less(b, p) && lexicographically_less(p, a);
}

} // namespace

void PolygonTriangulation::solve(std::span<const LocalIndex> polygon, std::vector<LocalIndex> &corners) {
  const std::size_t k = polygon.size();
  infinity_ = static_cast<Vertex>(k);
  point_.resize(k);
  for (std::size_t i = 0; i < k; ++i)
    point_[i] = sites_[index(polygon[i])];
  leaving_.resize(k + 1);
  spoke_.resize(k + 1);
  origin_.clear();
  twin_.clear();
  marked_.clear();
  round_ = 0;
  take_out();
  begin();
  for (std::size_t i = 3; i < k; ++i)
    insert(order_[i]);
  collect(polygon, corners);
}

/// Chooses the order of insertion, and takes the vertices out in the opposite one. The first three must not
/// be collinear.
void PolygonTriangulation::take_out() {
  const std::size_t k = point_.size();
  order_.resize(k);
  before_.resize(k);
  after_.resize(k);
  std::iota(order_.begin(), order_.end(), 0);
  Random random(k);
  for (std::size_t i = k - 1; i > 0; --i)
    std::swap(order_[i], order_[random.below(i + 1)]);
  std::size_t third = 2;
  while (orientation(point(order_[0]), point(order_[1]), point(order_[third])) == Sign::zero)
    ++third;
  std::swap(order_[2], order_[third]);
  for (std::size_t i = 0; i < k; ++i) {
    before_[i] = static_cast<Vertex>(i == 0 ? k - 1 : i - 1);
    after_[i] = static_cast<Vertex>(i + 1 == k ? 0 : i + 1);
  }
  for (std::size_t i = k - 1; i >= 3; --i) {
    const Vertex v = order_[i];
    after_[index(before_[index(v)])] = after_[index(v)];
    before_[index(after_[index(v)])] = before_[index(v)];
  }
}

void PolygonTriangulation::link(HalfEdge a, HalfEdge b) {
  twin_[index(a)] = b;
  twin_[index(b)] = a;
}

/// One triangle, and one with the point at infinity across each of its edges.
void PolygonTriangulation::begin() {
  Vertex a = order_[0], b = order_[1];
  const Vertex c = order_[2];
  if (orientation(point(a), point(b), point(c)) == Sign::negative)
    std::swap(a, b);
  origin_ = {a, b, c, b, a, infinity_, c, b, infinity_, a, c, infinity_};
  twin_.resize(origin_.size());
  marked_.assign(4, 0);
  for (HalfEdge h = 0; h < 3; ++h) {
    link(h, 3 * h + 3);
    link(3 * h + 4, 3 * ((h + 2) % 3) + 5);
    leaving_[index(origin(h))] = h;
  }
  leaving_[index(infinity_)] = 5;
}

/// Whether v lies in the circle of a triangle; that of a hull edge is the half-plane beyond, and the edge
/// itself.
bool PolygonTriangulation::in_conflict(Triangle t, Vertex v) const {
  const HalfEdge h = 3 * t;
  for (HalfEdge i = 0; i < 3; ++i)
    if (origin(h + i) == infinity_) {
      const Point from = point(origin(next(h + i))), to = point(origin(previous(h + i)));
      const Sign side = orientation(from, to, point(v));
      return side == Sign::positive || (side == Sign::zero && lies_between(point(v), from, to));
    }
  return in_circle(point(origin(h)), point(origin(h + 1)), point(origin(h + 2)), point(v)) == Sign::positive;
}

/// A triangle at a whose circle holds v, or `none`.
PolygonTriangulation::Triangle PolygonTriangulation::conflict_at(Vertex a, Vertex v) const {
  const HalfEdge first = leaving_[index(a)];
  HalfEdge h = first;
  do {
    if (in_conflict(h / 3, v))
      return h / 3;
    h = twin(previous(h));
  } while (h != first);
  return none;
}

bool PolygonTriangulation::mark(Triangle t) { return std::exchange(marked_[index(t)], round_) != round_; }

/// A triangle whose circle holds d, from one whose circle holds c, its neighbour on the polygon.
PolygonTriangulation::Triangle PolygonTriangulation::next_conflict(Triangle start, Vertex c, Vertex d) {
  ++round_;
  mark(start);
  cavity_.assign(1, start);
  for (std::size_t i = 0; i < cavity_.size(); ++i) {
    if (in_conflict(cavity_[i], d))
      return cavity_[i];
    for (HalfEdge h = 3 * cavity_[i]; h < 3 * cavity_[i] + 3; ++h) {
      const Triangle across = twin(h) / 3;
      if (!mark(across))
        continue;
      if (in_conflict(across, c))
        cavity_.push_back(across);
      else if (in_conflict(across, d))
        return across;
    }
  }
  assert(false);
  return none;
}

/// Any triangle whose circle holds v.
PolygonTriangulation::Triangle PolygonTriangulation::locate(Vertex v) {
  const Vertex a = before_[index(v)], b = after_[index(v)];
  if (const Triangle t = conflict_at(a, v); t != none)
    return t;
  if (const Triangle t = conflict_at(b, v); t != none)
    return t;
  const auto k = static_cast<Vertex>(point_.size());
  const auto steps = [k](Vertex from, Vertex to) { return to < from ? to - from + k : to - from; };
  const bool up = steps(a, v) <= steps(v, b);
  const auto step = [&](Vertex c) { return up ? (c + 1 == k ? 0 : c + 1) : (c == 0 ? k - 1 : c - 1); };
  Vertex c = step(up ? a : b);
  Triangle t = conflict_at(up ? a : b, c);
  while (c != v) {
    const Vertex d = step(c);
    t = next_conflict(t, c, d);
    c = d;
  }
  return t;
}

/// Replaces the triangles whose circles hold v by those between v and their boundary.
void PolygonTriangulation::insert(Vertex v) {
  const Triangle start = locate(v);
  ++round_;
  mark(start);
  cavity_.assign(1, start);
  rim_.clear();
  for (std::size_t i = 0; i < cavity_.size(); ++i)
    for (HalfEdge h = 3 * cavity_[i]; h < 3 * cavity_[i] + 3; ++h) {
      const Triangle across = twin(h) / 3;
      if (marked_[index(across)] == round_)
        continue;
      if (in_conflict(across, v)) {
        mark(across);
        cavity_.push_back(across);
      } else {
        rim_.push_back(twin(h));
      }
    }
  // Two more than before.
  for (std::size_t i = cavity_.size(); i < rim_.size(); ++i) {
    cavity_.push_back(static_cast<Triangle>(marked_.size()));
    marked_.push_back(0);
  }
  origin_.resize(3 * marked_.size());
  twin_.resize(3 * marked_.size());
  for (std::size_t i = 0; i < rim_.size(); ++i) {
    const Vertex q = origin(rim_[i]), p = origin(next(rim_[i]));
    const HalfEdge h = 3 * cavity_[i]; // p -> q, q -> v, v -> p
    origin_[index(h)] = p;
    origin_[index(h + 1)] = q;
    origin_[index(h + 2)] = v;
    link(h, rim_[i]);
    leaving_[index(p)] = h;
    spoke_[index(p)] = h + 2;
  }
  for (std::size_t i = 0; i < rim_.size(); ++i) {
    const HalfEdge h = 3 * cavity_[i] + 1;
    link(h, spoke_[index(origin(h))]);
  }
  leaving_[index(v)] = 3 * cavity_[0] + 2;
}

/// Those on the left of the polygon's edges, and whatever can be reached from them without crossing one.
void PolygonTriangulation::collect(std::span<const LocalIndex> polygon, std::vector<LocalIndex> &corners) {
  const auto is_border = [&](HalfEdge h) {
    const Vertex from = origin(h);
    return origin(next(h)) == (from + 1 == infinity_ ? 0 : from + 1);
  };
  ++round_;
  cavity_.clear();
  for (HalfEdge h = 0; index(h) < origin_.size(); ++h)
    if (origin(h) != infinity_ && is_border(h) && mark(h / 3))
      cavity_.push_back(h / 3);
  for (std::size_t i = 0; i < cavity_.size(); ++i)
    for (HalfEdge h = 3 * cavity_[i]; h < 3 * cavity_[i] + 3; ++h) {
      corners.push_back(polygon[index(origin(h))]);
      if (!is_border(h) && mark(twin(h) / 3))
        cavity_.push_back(twin(h) / 3);
    }
}

} // namespace dovetail
