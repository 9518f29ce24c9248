#include "cavity_polygon.hpp"

#include "dovetail/geometry/predicates.hpp"

#include <array>
#include <cassert>
#include <numeric>

namespace dovetail {
namespace {

constexpr std::size_t index(LocalIndex i) { return static_cast<std::size_t>(i); }
constexpr LocalIndex next(LocalIndex h) { return h % 3 == 2 ? h - 2 : h + 1; }
constexpr LocalIndex previous(LocalIndex h) { return h % 3 == 0 ? h + 2 : h - 1; }

constexpr std::uint8_t is_candidate = 1;
constexpr std::uint8_t is_off = 2;

/// The next number of a sequence: splitmix64.
std::size_t random_below(std::uint64_t &state, std::size_t bound) {
  std::uint64_t v = state += 0x9e3779b97f4a7c15U;
  v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9U;
  v = (v ^ (v >> 27)) * 0x94d049bb133111ebU;
  return (v ^ (v >> 31)) % bound;
}

} // namespace

void CavityPolygon::triangulate(std::span<const Point> chain) {
  chain_ = chain;
  const std::size_t places = chain.size();
  assert(places >= 3);
  before_.resize(places);
  after_.resize(places);
  std::iota(before_.begin(), before_.end(), -1);
  std::iota(after_.begin(), after_.end(), 1);
  corner_.clear();
  twin_.clear();
  inside_.assign(places, none);
  take_off();
  const Place last = static_cast<Place>(places - 1);
  const HalfEdge first = add_triangle(0, last, after_[0]);
  inside_[index(last)] = first + 2;
  inside_[index(after_[0])] = first;
  inside_[0] = first + 1;
  for (std::size_t i = taken_off_.size(); i-- > 0;)
    put_back(taken_off_[i]);
}

/// The chain runs clockwise around the polygon.
bool CavityPolygon::convex(Place u) const {
  return orientation(point(before_[index(u)]), point(u), point(after_[index(u)])) == Sign::negative;
}

/// All inner vertices but one.
void CavityPolygon::take_off() {
  const std::size_t inner = chain_.size() - 2;
  const Place last = static_cast<Place>(inner + 1);
  taken_off_.clear();
  candidates_.resize(inner);
  std::iota(candidates_.begin(), candidates_.end(), 1);
  state_.assign(chain_.size(), is_candidate);
  std::uint64_t random = inner;
  while (taken_off_.size() + 1 < inner) {
    const std::size_t drawn = random_below(random, candidates_.size());
    const Place u = candidates_[drawn];
    candidates_[drawn] = candidates_.back();
    candidates_.pop_back();
    state_[index(u)] = 0;
    if (!convex(u))
      continue; // until a neighbour goes
    state_[index(u)] = is_off;
    taken_off_.push_back(u);
    const Place p = before_[index(u)], n = after_[index(u)];
    after_[index(p)] = n;
    before_[index(n)] = p;
    for (const Place neighbour : {p, n})
      if (neighbour != 0 && neighbour != last && state_[index(neighbour)] == 0) {
        state_[index(neighbour)] = is_candidate;
        candidates_.push_back(neighbour);
      }
  }
}

void CavityPolygon::link(HalfEdge a, HalfEdge b) {
  twin_[index(a)] = b;
  twin_[index(b)] = a;
}

/// Its first half-edge, across from a.
CavityPolygon::HalfEdge CavityPolygon::add_triangle(Place a, Place b, Place c) {
  HalfEdge h = static_cast<HalfEdge>(corner_.size());
  if (free_.empty()) {
    corner_.resize(corner_.size() + 3);
    twin_.resize(twin_.size() + 3);
  } else {
    h = 3 * free_.back();
    free_.pop_back();
  }
  const std::array<Place, 3> corners{a, b, c};
  for (std::size_t i = 0; i < 3; ++i) {
    corner_[index(h) + i] = corners[i];
    twin_[index(h) + i] = none;
  }
  return h;
}

bool CavityPolygon::in_conflict(HalfEdge h, Place u) const {
  const std::size_t base = index(h - h % 3);
  const Point a = point(corner_[base]), b = point(corner_[base + 1]), c = point(corner_[base + 2]);
  const Point d = point(u);
  return a != d && b != d && c != d && in_circle(a, b, c, d) == Sign::positive;
}

/// Replaces the triangles whose circles hold u, as far as it sees them through the edge of its neighbours, by
/// a fan around u.
void CavityPolygon::put_back(Place u) {
  const Place p = before_[index(u)], n = after_[index(u)];
  rim_.clear();
  to_dig_.assign(1, {p, n, inside_[index(p)]});
  while (!to_dig_.empty()) {
    const Rim edge = to_dig_.back();
    to_dig_.pop_back();
    if (edge.outside == none || !in_conflict(edge.outside, u)) {
      rim_.push_back(edge);
      continue;
    }
    const HalfEdge left = previous(edge.outside), right = next(edge.outside);
    const Place tip = corner_[index(edge.outside)];
    free_.push_back(edge.outside / 3);
    to_dig_.push_back({tip, edge.to, twin_[index(left)]});
    to_dig_.push_back({edge.from, tip, twin_[index(right)]});
  }
  HalfEdge before = none;
  for (const Rim &edge : rim_) {
    const HalfEdge h = add_triangle(u, edge.from, edge.to);
    if (edge.outside == none)
      inside_[index(edge.to)] = h;
    else
      link(h, edge.outside);
    if (before == none)
      inside_[index(p)] = h + 2;
    else
      link(h + 2, before);
    before = h + 1;
  }
  inside_[index(u)] = before;
}

} // namespace dovetail
