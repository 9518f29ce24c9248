/// Which triangles are skinny, and which of them may be (mesh/refine.hpp states the rule). Local.
#pragma once

#include "dovetail/geometry/constructions.hpp"
#include "dovetail/mesh/domain.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace dovetail {

/// Squared sides, [i] across from corner i.
struct SquaredSides {
  std::array<double, 3> side;
  std::size_t shortest() const {
    const std::size_t i = side[1] < side[0] ? 1 : 0;
    return side[2] < side[i] ? 2 : i;
  }
  double least() const { return std::min(std::min(side[0], side[1]), side[2]); }
};

/// A bound on the smallest angle, for comparisons without roots and quotients.
class AngleBound {
public:
  /// Degrees; 0: none.
  explicit AngleBound(double degrees);
  double degrees() const { return degrees_; }
  /// Half the cotangent of the half: see off_center.
  double reach() const { return reach_; }
  /// Of the squared sides of a triangle, a the shortest: whether the angle across from a is below the bound.
  bool is_below(double a, double b, double c) const {
    const double twice_dot = b + c - a; // 2 |b| |c| cos
    return twice_dot * twice_dot > four_squared_cosine_ * (b * c);
  }
  /// By minima and maxima: which side is the shortest, no processor guesses.
  bool is_below(const SquaredSides &sides) const {
    const double shorter = std::min(sides.side[0], sides.side[1]);
    const double longer = std::max(sides.side[0], sides.side[1]);
    return is_below(std::min(shorter, sides.side[2]), std::max(shorter, sides.side[2]), longer);
  }

private:
  double degrees_;
  double four_squared_cosine_;
  double reach_;
};

constexpr SquaredSides squared_sides(Point a, Point b, Point c) {
  return {{squared_distance(b, c), squared_distance(c, a), squared_distance(a, b)}};
}

/// Degrees.
double smallest_angle(Point a, Point b, Point c);

/// Of each vertex: the segment that it lies on between its ends, `input_vertex` if it is the end of one, else
/// `none`: inside the domain.
inline constexpr LocalIndex input_vertex = -2;
std::vector<LocalIndex> segments_of_vertices(const DomainMesh &mesh, std::span<const Segment> segments);

/// Where segments meet at small angles, and which triangles are excused by that.
class SmallAngles {
public:
  SmallAngles(std::span<const Point> vertices, std::span<const Segment> segments);

  /// No angle between segments is below 60 degrees.
  bool none_at_all() const { return sharp_count_ == 0; }
  /// Two segments of this vertex make an angle below 60 degrees.
  bool is_sharp(LocalIndex vertex) const {
    return static_cast<std::size_t>(vertex) < sharp_.size() && sharp_[static_cast<std::size_t>(vertex)] != 0;
  }
  /// Rule (shell): the segments of p and q, which lie inside them, meet at an angle below 60 degrees, p and q
  /// being at the same distance from there.
  bool on_one_shell(Point p, LocalIndex segment_of_p, Point q, LocalIndex segment_of_q) const;

private:
  LocalIndex meeting(const Segment &a, const Segment &b) const;
  Displacement direction(const Segment &segment, LocalIndex from) const;

  std::vector<Point> vertices_; ///< at least up to the last end of a segment
  std::vector<Segment> segments_;
  std::vector<std::uint8_t> sharp_; ///< by vertex
  std::size_t sharp_count_ = 0;
};

/// Whether a triangle below a bound is a legitimate exception, by rule (corner) or (shell).
bool is_exempt(const DomainMesh &mesh, LocalIndex triangle, const SmallAngles &small_angles,
               std::span<const LocalIndex> segments_of_vertices);

} // namespace dovetail
