#include "border_triangulation.hpp"

#include "dovetail/geometry/predicates.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace dovetail {
namespace {

/// Longer polygons are worth the preparations of PolygonTriangulation.
constexpr std::size_t most_by_search = 64;

std::size_t index(LocalIndex i) { return static_cast<std::size_t>(i); }

} // namespace

/// Whenever the walk comes back to a vertex, the loop since then is cut off: two vertices are an edge walked
/// there and back, more are a simple polygon.
void BorderTriangulation::solve(std::span<const LocalIndex> walk) {
  open_.clear();
  const auto close_loop = [&](std::size_t begin) {
    if (open_.size() - begin >= 3)
      solve_simple(std::span(open_).subspan(begin));
  };
  for (const LocalIndex v : walk) {
    if (place_[index(v)] != none) {
      const std::size_t begin = index(place_[index(v)]);
      close_loop(begin);
      for (std::size_t i = begin + 1; i < open_.size(); ++i)
        place_[index(open_[i])] = none;
      open_.resize(begin + 1);
    } else {
      place_[index(v)] = static_cast<LocalIndex>(open_.size());
      open_.push_back(v);
    }
  }
  close_loop(0);
  for (const LocalIndex v : open_)
    place_[index(v)] = none;
}

/// Cuts off the triangle on one edge, and what remains on both sides of it, as long as that is few.
void BorderTriangulation::solve_simple(std::span<const LocalIndex> polygon) {
  if (polygon.size() > most_by_search)
    return long_.solve(polygon, corners_);
  std::vector<std::vector<LocalIndex>> waiting;
  waiting.emplace_back(polygon.begin(), polygon.end());
  while (!waiting.empty()) {
    const std::vector<LocalIndex> loop = std::move(waiting.back());
    waiting.pop_back();
    const std::size_t top = apex(loop);
    corners_.insert(corners_.end(), {loop.back(), loop.front(), loop[top]});
    const auto middle = loop.begin() + static_cast<std::ptrdiff_t>(top);
    if (loop.end() - middle >= 3)
      waiting.emplace_back(middle, loop.end());
    if (top + 1 >= 3)
      waiting.emplace_back(loop.begin(), middle + 1);
  }
}

/// The corner across from the edge from the last vertex to the first: of those on its left, the one whose
/// circle through the edge holds no other. It is a corner of a Delaunay triangle, so it sees the edge.
std::size_t BorderTriangulation::apex(std::span<const LocalIndex> polygon) const {
  const Point from = sites_[index(polygon.back())], to = sites_[index(polygon.front())];
  std::size_t best = 0;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    const Point p = sites_[index(polygon[i])];
    if (orientation(from, to, p) == Sign::positive &&
        (best == 0 || in_circle(from, to, sites_[index(polygon[best])], p) == Sign::positive))
      best = i;
  }
  assert(best != 0);
  return best;
}

} // namespace dovetail
