#include "triangle_hints.hpp"

#include <algorithm>
#include <cmath>

namespace dovetail {
namespace {

std::size_t at(LocalIndex i) { return static_cast<std::size_t>(i); }

void fetch_record(const Triangulation &mesh, LocalIndex triangle) {
  __builtin_prefetch(&mesh.corners[3 * at(triangle)]);
  __builtin_prefetch(&mesh.neighbours[3 * at(triangle)]);
}

/// A visibility walk (mesh/locate.hpp) without exactness. Its turn has two halves, and what each needs is
/// fetched while others have theirs.
class RoughWalk {
public:
  RoughWalk(Point point, std::size_t index, LocalIndex begin, const Triangulation &mesh)
      : point_(point), index_(index), triangle_(begin) {
    fetch_record(mesh, begin);
  }

  std::size_t index() const { return index_; }
  LocalIndex triangle() const { return triangle_; }

  void fetch_corners(std::span<const Point> vertices, const Triangulation &mesh) const {
    for (std::size_t i = 0; i < 3; ++i)
      __builtin_prefetch(&vertices[at(mesh.corners[3 * at(triangle_) + i])]);
  }

  /// Crosses the side that the point is farthest beyond. False if there is none, or no triangle there, or if
  /// it has been long on its way.
  bool step(std::span<const Point> vertices, const Triangulation &mesh) {
    const std::size_t first = 3 * at(triangle_);
    const Point a = vertices[at(mesh.corners[first])], b = vertices[at(mesh.corners[first + 1])],
                c = vertices[at(mesh.corners[first + 2])];
    const double turn[3] = {turn_of(b, c), turn_of(c, a), turn_of(a, b)};
    // Any of the three is as likely, so there is no branch on it.
    const std::size_t least = turn[1] < turn[0] ? 1 : 0;
    const std::size_t side = turn[2] < turn[least] ? 2 : least;
    const LocalIndex beyond = mesh.neighbours[first + side];
    if (!(turn[side] < 0) || beyond == none || --steps_left_ == 0)
      return false;
    triangle_ = beyond;
    fetch_record(mesh, triangle_);
    return true;
  }

private:
  double turn_of(Point from, Point to) const {
    return (from.x - point_.x) * (to.y - point_.y) - (from.y - point_.y) * (to.x - point_.x);
  }

  Point point_;
  std::size_t index_; ///< of the point
  LocalIndex triangle_;
  int steps_left_ = 1000; ///< many times what the sample leaves to go, unless rounding leads it in a circle
};

} // namespace

TriangleHints::TriangleHints(std::span<const Point> vertices, const Triangulation &mesh,
                             std::span<const Point> points) {
  // A walk takes sqrt(triangles / samples) steps, each of which costs about twice what a sample does: walks
  // and samples together cost least at this number of samples.
  const auto triangles = static_cast<double>(mesh.triangle_count()),
             sought = static_cast<double>(points.size());
  const double samples = std::min(triangles, std::cbrt(sought * sought * triangles));
  constexpr double samples_of_a_cell = 2;
  side_ = static_cast<std::size_t>(std::sqrt(samples / samples_of_a_cell)) + 1;
  cells_.assign(side_ * side_, none);
  if (points.empty())
    return;
  const auto [left, right] = std::ranges::minmax(points, {}, &Point::x);
  const auto [lowest, highest] = std::ranges::minmax(points, {}, &Point::y);
  low_ = {left.x, lowest.y};
  const auto side = static_cast<double>(side_);
  per_x_ = side / (right.x - left.x);
  per_y_ = side / (highest.y - lowest.y);
  const auto is_in_box = [&](Point p) {
    return left.x <= p.x && p.x <= right.x && lowest.y <= p.y && p.y <= highest.y;
  };
  const double stride = triangles / samples;
  const auto sample = [&](double i) {
    return std::min(static_cast<std::size_t>(i * stride), mesh.corners.size() / 3 - 1);
  };
  const auto corner = [&](double i) -> const LocalIndex & { return mesh.corners[3 * sample(i)]; };
  constexpr double ahead = 16; // samples: one is fetched in the meantime, and before that its corner
  for (double i = 0; i < samples; ++i) {
    __builtin_prefetch(&corner(i + 2 * ahead));
    __builtin_prefetch(&vertices[at(corner(i + ahead))]);
    if (const Point p = vertices[at(corner(i))]; is_in_box(p))
      cells_[cell(p)] = static_cast<LocalIndex>(sample(i));
  }
  // What the sample has missed is near to what it has next to it.
  LocalIndex before = 0;
  for (LocalIndex &triangle : cells_)
    before = triangle = triangle == none ? before : triangle;
}

std::vector<LocalIndex> TriangleHints::near(std::span<const Point> vertices, const Triangulation &mesh,
                                            std::span<const Point> points) const {
  constexpr std::size_t most_walks = 16; // more than memory answers at a time
  std::vector<LocalIndex> found(points.size());
  std::vector<RoughWalk> walks;
  std::size_t begun = 0;
  const auto begin_next = [&] {
    const RoughWalk walk(points[begun], begun, cells_[cell(points[begun])], mesh);
    ++begun;
    return walk;
  };
  while (walks.size() < most_walks && begun < points.size())
    walks.push_back(begin_next());
  while (!walks.empty()) {
    for (const RoughWalk &walk : walks)
      walk.fetch_corners(vertices, mesh);
    for (std::size_t i = 0; i < walks.size();) {
      RoughWalk &walk = walks[i];
      if (walk.step(vertices, mesh)) {
        ++i;
        continue;
      }
      found[walk.index()] = walk.triangle();
      if (begun < points.size()) {
        walk = begin_next();
        ++i;
      } else {
        walk = walks.back();
        walks.pop_back();
      }
    }
  }
  return found;
}

std::size_t TriangleHints::cell(Point point) const {
  // Points in a row or far apart make these infinite or not a number, and any cell will do.
  const auto along = [&](double distance, double per_unit) {
    const double cells = distance * per_unit;
    return cells > 0 ? std::min(side_ - 1, static_cast<std::size_t>(std::min(cells, 1e9))) : 0;
  };
  return along(point.x - low_.x, per_x_) * side_ + along(point.y - low_.y, per_y_);
}

} // namespace dovetail
