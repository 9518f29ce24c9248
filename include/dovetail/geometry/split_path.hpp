/// Split paths: the sites whose Voronoi cells meet a split line, as lower hulls. Local; exact; knows no
/// ranks.
///
/// The path of a set of sites for a line is the lower convex hull of the sites projected to
/// (along, (across - m)^2 + along^2), in ascending order along the line. It runs from the lowest to the
/// highest site; among sites equal in `along` only the nearest to the line can be on it, and of two exactly
/// as near the one beyond the line (of greater `across`). A set that is not empty has a path of at least one
/// site. A site that is given twice counts once. Facts F1 and F5 to F7 in include/dovetail/README.md; after
/// Blelloch, Miller and Talmor, Developing a practical projection-based parallel Delaunay algorithm, 1996.
#pragma once

#include "dovetail/base/types.hpp"
#include "dovetail/geometry/predicates.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dovetail {

/// A site with the number its owner gave it; the number has no influence on any path.
struct PathSite {
  Point point;
  GlobalIndex number;
  friend constexpr bool operator==(const PathSite &, const PathSite &) = default;
};

/// Strictly ascending along the line, if it is a split path.
using Path = std::vector<PathSite>;

/// The path of sites in any order. O(n log n), and O(n) if they already ascend along the line.
Path split_path(std::vector<PathSite> sites, SplitLine line);

/// The path of sites that ascend along the line (equals in any order). O(n).
Path split_path_of_ascending(std::span<const PathSite> sites, SplitLine line);

/// The path of the union of two chains that both ascend along the line, such as two paths. O(a + b).
Path hull_of_both(std::span<const PathSite> a, std::span<const PathSite> b, SplitLine line);

/// The path of sites in the total order of the line's axis, site i having the number first_number + i.
/// Meant for a slab's own sites and one of its borders: if the line is at or beyond either end of them, all
/// sites are seen once, most of them only for their `along`, and few are ever sorted: O(n) for uniform
/// sites, some nanoseconds each. For a line among them it is O(n log n).
Path own_hull(std::span<const Point> sites, GlobalIndex first_number, SplitLine line);

/// Which further sites can be on a path, seeing the path of some of the sites for the same line: those inside
/// or on a circle centred on the line through two consecutive sites of the approximate path, and those lower
/// or higher than both its ends. A path of less than two sites lets everything through.
class PathFilter {
public:
  /// O(approximate path).
  PathFilter(std::span<const PathSite> approximate, SplitLine line);

  /// Never false for a site that can be on the true path; rounding may let a little more through.
  /// Constant time for nearly all that it rejects, O(log(approximate path)) for the rest.
  bool lets_through(Point site) const {
    const double position = along(site, line_.axis);
    const double distance = std::fabs(across(site, line_.axis) - line_.position);
    return !(distance > band_reach_[band(position)]) && is_within_reach(position, distance);
  }

  /// No site between the ends of the approximate path and farther from the line than this is let through.
  double reach() const { return reach_; }

  /// Positions strictly between `low` and `high` along the line: an interval about the middle of the path in
  /// which nothing at this distance or farther is let through. May be empty. O(approximate path).
  struct Interval {
    double low;
    double high;
  };
  Interval quiet_interval(double distance) const;

private:
  bool is_within_reach(double position, double distance) const;

  /// Bands of `along`, numbered upwards: all alike near the middle of the path, wider in proportion to the
  /// distance from it beyond. The leading bits of a double that is at least 1 are just such a number.
  std::size_t band(double position) const {
    const double distance = std::fabs(position - middle_) * per_scale_ + 1.0;
    const std::uint64_t steps =
        (std::bit_cast<std::uint64_t>(distance) - std::bit_cast<std::uint64_t>(1.0)) >> shift_;
    const std::size_t from_middle = std::min<std::size_t>(steps, half_ - 1);
    return position < middle_ ? half_ - 1 - from_middle : half_ + from_middle;
  }
  void choose_bands();

  SplitLine line_;
  double reach_;
  double middle_ = 0;
  double per_scale_ = 0;
  int shift_ = 52;
  std::size_t half_ = 1;           ///< bands below the middle, and as many above
  std::vector<double> band_reach_; ///< the largest reach of the pairs of path sites that meet the band
  std::vector<double> position_;   ///< of the path sites, along the line
  std::vector<double> distance_;   ///< of the path sites from the line
  std::vector<double> pair_reach_; ///< of each path site and the next
};

} // namespace dovetail
