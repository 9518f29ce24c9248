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
Path merge_paths(std::span<const PathSite> a, std::span<const PathSite> b, SplitLine line);

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
  bool lets_through(Point site) const;

  /// No site between the ends of the approximate path and farther from the line than this is let through.
  double reach() const { return reach_; }

private:
  bool lets_through_between(double position, double distance) const;

  /// Bands of `along`, numbered upwards: as wide as each other near the middle of the path and wider in
  /// proportion to the distance from it outside. Each has the largest reach of the pairs that meet it.
  std::size_t band(double position) const;

  SplitLine line_;
  double reach_ = 0;
  double middle_ = 0;
  double per_scale_ = 0; ///< bands become wider beyond the distance 1 / per_scale_ from the middle
  int shift_ = 0;
  std::size_t half_ = 1; ///< bands below, and as many above the middle
  std::vector<double> band_reach_;
  std::vector<double> position_; ///< along, of the approximate path
  std::vector<double> distance_; ///< from the line
};

} // namespace dovetail
