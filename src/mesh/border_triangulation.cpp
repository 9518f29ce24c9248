#include "border_triangulation.hpp"

#include "dovetail/geometry/predicates.hpp"

#include <cassert>
#include <cmath>
#include <cstddef>

namespace dovetail {
namespace {

std::size_t index(LocalIndex i) { return static_cast<std::size_t>(i); }

/// An edge from l to r, and of the sites seen so far the one on its left that sees it under the largest
/// angle.
///
/// A site p is looked at once: the product of the complex conj(p - l) and p - r has the angle under which p
/// sees the edge for its argument, and the orientation of l, r, p for its imaginary part. Of two sites on the
/// left, the one under the larger angle is inside the circle of the other; so the determinant of in_circle is
/// that of their two products.
///
/// Let u = 2^-53. Differences have the relative error u, so both parts are wrong by at most 4u |p - l| |p -
/// r| plus higher orders, less than 5u of `size`, which is the sum of both without signs, and the determinant
/// by less than 20u of the product of two sizes; 8 and 32 leave room for the rest. Products that underflow
/// lose at most 2^-1074 each, scaled by the size that they meet: far less than what 2^-500 on every size
/// adds.
class Apex {
public:
  Apex(Point l, Point r) : l_(l), r_(r) {}

  std::size_t place() const { return place_; }

  void consider(std::size_t place, Point p) {
    const double lx = p.x - l_.x, ly = p.y - l_.y, rx = p.x - r_.x, ry = p.y - r_.y;
    const double re = lx * rx + ly * ry, im = lx * ry - ly * rx;
    const double size = std::fabs(re) + std::fabs(im) + 0x1p-500;
    if (!(im > 0x1p-50 * size) && !is_left(im, size, p))
      return;
    const double determinant = re_ * im - re * im_, bound = scaled_size_ * size;
    if (!(determinant > bound) && !is_inside(determinant, bound, p))
      return;
    place_ = place;
    best_ = p;
    re_ = re;
    im_ = im;
    scaled_size_ = 0x1p-48 * size;
  }

private:
  bool is_left(double im, double size, Point p) const {
    return !(-im > 0x1p-50 * size) && orientation(l_, r_, p) == Sign::positive;
  }
  bool is_inside(double determinant, double bound, Point p) const {
    return place_ == 0 || (!(-determinant > bound) && in_circle(l_, r_, best_, p) == Sign::positive);
  }

  Point l_, r_, best_{};
  std::size_t place_ = 0;                    ///< 0: none yet, and
  double re_ = 1, im_ = 0, scaled_size_ = 0; ///< an angle of zero
};

} // namespace

/// Whenever the walk comes back to a vertex, the loop since then is cut off: two vertices are an edge walked
/// there and back, more are a simple polygon.
void BorderTriangulation::solve(std::span<const LocalIndex> walk, std::span<const RankedSite> inside) {
  inside_.clear();
  for (const RankedSite &ranked : inside)
    inside_.push_back(corner(ranked.site));
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

/// Longer polygons are worth the preparations of PolygonTriangulation.
void BorderTriangulation::solve_simple(std::span<const LocalIndex> polygon) {
  if (polygon.size() > longest_around_sites)
    return solve_long(polygon);
  polygon_.clear();
  for (const LocalIndex v : polygon)
    polygon_.push_back(corner(v));
  const LocalIndex base = solve_by_search(0);
  twins_.meet(base, polygon.back(), polygon.front());
}

void BorderTriangulation::solve_long(std::span<const LocalIndex> polygon) {
  corners_.clear();
  long_.solve(polygon, corners_);
  for (std::size_t i = 0; i < corners_.size(); i += 3) {
    const LocalIndex a = corners_[i], b = corners_[i + 1], c = corners_[i + 2];
    const LocalIndex side = twins_.add(a, b, c);
    twins_.meet(side, b, c);
    twins_.meet(side + 1, c, a);
    twins_.meet(side + 2, a, b);
  }
}

/// Cuts off the triangle on the edge from the last vertex to the first, and solves what remains of the
/// polygon that begins there on the stack. Returns the side that the triangle has on that edge.
///
///            apex                                        apex
///           /    \        front ... apex ... back        /  \         front ... back, apex
///      .---/      \---.   become two polygons       .   /    \   .    are one polygon
///      '--/________\--'                             |  /______\  |
///       front <- back                               front <- back
LocalIndex BorderTriangulation::solve_by_search(std::size_t begin) {
  const std::size_t size = polygon_.size() - begin;
  const LocalIndex front = polygon_[begin].vertex, back = polygon_.back().vertex;
  const std::size_t top = apex(begin);
  if (top >= size) {
    const Corner found = inside_[top - size];
    inside_[top - size] = inside_.back();
    inside_.pop_back();
    const LocalIndex side = twins_.add(found.vertex, back, front);
    twins_.meet(side + 2, found.vertex, back);
    polygon_.push_back(found);
    twins_.join(side + 1, solve_by_search(begin));
    return side;
  }
  const LocalIndex vertex = polygon_[begin + top].vertex;
  const LocalIndex side = twins_.add(vertex, back, front);
  if (top + 2 == size)
    twins_.meet(side + 2, vertex, back);
  else
    twins_.join(side + 2, solve_by_search(begin + top));
  polygon_.resize(begin + top + 1);
  if (top == 1)
    twins_.meet(side + 1, front, vertex);
  else
    twins_.join(side + 1, solve_by_search(begin));
  return side;
}

/// The corner across from the edge from the last vertex to the first, a place in the polygon or, behind it,
/// in inside_: of those on the left of the edge, the one whose circle through the edge holds no other. It is
/// a corner of a Delaunay triangle, so it sees the edge.
std::size_t BorderTriangulation::apex(std::size_t begin) const {
  const std::size_t size = polygon_.size() - begin;
  if (size == 3 && inside_.empty())
    return 1;
  const Corner *polygon = polygon_.data() + begin;
  Apex apex(polygon[size - 1].point, polygon[0].point);
  for (std::size_t i = 1; i + 1 < size; ++i)
    apex.consider(i, polygon[i].point);
  for (std::size_t i = 0; i < inside_.size(); ++i)
    apex.consider(size + i, inside_[i].point);
  assert(apex.place() != 0);
  return apex.place();
}

} // namespace dovetail
