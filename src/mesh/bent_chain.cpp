#include "bent_chain.hpp"

#include "dovetail/geometry/predicates.hpp"

#include <algorithm>
#include <cmath>

namespace dovetail {

BentChain::BentChain(std::span<const Point> vertices, Piece piece, std::span<const LocalIndex> beside)
    : vertices_(vertices), beside_(beside), chain_{piece.from, piece.to}, members_{piece.from, piece.to} {
  const Point a = point(piece.from), b = point(piece.to);
  by_x_ = std::fabs(0.5 * b.x - 0.5 * a.x) >= std::fabs(0.5 * b.y - 0.5 * a.y);
  ascending_ = by_x_ ? a.x < b.x : a.y < b.y;
  other_ascending_ = by_x_ ? a.y < b.y : a.x < b.x;
}

bool BentChain::is_before(LocalIndex p, LocalIndex q) const {
  const auto along = [&](LocalIndex v) { return by_x_ ? point(v).x : point(v).y; };
  const auto across = [&](LocalIndex v) { return by_x_ ? point(v).y : point(v).x; };
  if (along(p) != along(q))
    return (along(p) < along(q)) == ascending_;
  return across(p) != across(q) && (across(p) < across(q)) == other_ascending_;
}

void BentChain::divide(std::vector<LocalIndex> on_piece) {
  std::ranges::sort(on_piece, [&](LocalIndex p, LocalIndex q) { return is_before(p, q); });
  chain_.insert(chain_.end() - 1, on_piece.begin(), on_piece.end());
  members_.insert(on_piece.begin(), on_piece.end());
}

void BentChain::bend(std::vector<LocalIndex> bends) {
  std::ranges::sort(bends, [&](LocalIndex p, LocalIndex q) { return is_before(p, q); });
  for (const LocalIndex w : bends)
    if (!members_.contains(w))
      bend_to(w);
}

/// Vertices in the triangle, its sides included, that the chain does not go through.
std::vector<LocalIndex> BentChain::swept(LocalIndex a, LocalIndex w, LocalIndex b) const {
  const Sign side = orientation(point(a), point(b), point(w));
  std::vector<LocalIndex> found;
  for (const LocalIndex q : beside_)
    if (q != w && orientation(point(a), point(b), point(q)) != -side &&
        orientation(point(b), point(w), point(q)) != -side &&
        orientation(point(w), point(a), point(q)) != -side && !members_.contains(q))
      found.push_back(q);
  std::ranges::sort(found, [&](LocalIndex p, LocalIndex q) { return is_before(p, q); });
  return found;
}

/// From the end of the path, past the obstacles, to a vertex: the convex chain that has all obstacles on one
/// side.
void BentChain::append_taut(std::vector<LocalIndex> &path, std::span<const LocalIndex> obstacles,
                            LocalIndex to, Sign side) const {
  const std::size_t first = path.size() - 1;
  const auto append = [&](LocalIndex v) {
    while (path.size() > first + 1 &&
           orientation(point(path[path.size() - 2]), point(path.back()), point(v)) != side)
      path.pop_back();
    path.push_back(v);
  };
  std::ranges::for_each(obstacles, append);
  append(to);
}

void BentChain::bend_to(LocalIndex w) {
  const auto after = std::upper_bound(chain_.begin() + 1, chain_.end() - 1, w,
                                      [&](LocalIndex p, LocalIndex q) { return is_before(p, q); });
  const LocalIndex a = *(after - 1), b = *after;
  const Sign side = orientation(point(a), point(b), point(w));
  std::vector<LocalIndex> path{a};
  if (side == Sign::zero) {
    path.push_back(w);
  } else {
    const std::vector<LocalIndex> obstacles = swept(a, w, b);
    const auto middle =
        std::ranges::find_if(obstacles, [&](LocalIndex q) { return is_before(w, q); }) - obstacles.begin();
    const std::span all(obstacles);
    append_taut(path, all.first(static_cast<std::size_t>(middle)), w, side);
    append_taut(path, all.subspan(static_cast<std::size_t>(middle)), b, side);
    path.pop_back();
  }
  pulled_ += path.size() - 2;
  members_.insert(path.begin(), path.end());
  chain_.insert(after, path.begin() + 1, path.end());
}

} // namespace dovetail
