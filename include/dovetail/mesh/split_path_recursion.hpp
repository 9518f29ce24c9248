/// Canonical Delaunay triangulation of one process's points by recursive splits along Delaunay paths, as
/// published by Blelloch, Miller and Talmor (Developing a practical projection-based parallel Delaunay
/// algorithm, 1996; with Hardwick, Design and implementation of a practical parallel Delaunay algorithm,
/// 1999): all work is in the splits, nothing is merged. Independent of `delaunay`
/// (mesh/divide_and_conquer.hpp) in everything but the predicates, and slower: the reference that `delaunay`
/// is compared with.
///
/// What is split, and why it stays exact for cuts in both directions. A subproblem is a box between split
/// lines, and its triangles are those with their circumcenter in it. Its sites are those whose Voronoi cells
/// meet the box: the ones whose cells meet the box's boundary are its border B, all others its interior P,
/// with cells inside the box. At any point of the box the nearest of its sites is the nearest of all, so the
/// part within the box of the path that these sites alone make is exact; the rest is clipped at the corners.
/// Going round the boundary of the box, the cells that are met, one after another, are B as a closed walk
/// along Delaunay edges, pinched where the box is crossed by a single cell or edge. A cut leaves each half a
/// part of the walk and the new path; the sites of the path leave P. The walk bounds exactly the triangles of
/// the box, and the recursion ends where it can be triangulated by itself, with few sites inside or none.
///
/// Three things are done otherwise than published, and none of them changes a path. The hull of a large box
/// is made of a strip along the line, and of what lies on or below its chords (F6): few sites, which leaves
/// the division of the orders as the linear work of a split. Ends of paths are looked up in the two chains
/// that the line crosses. The last few sites inside are not split any more.
#pragma once

#include "dovetail/mesh/triangulation.hpp"

#include <cstdint>
#include <vector>

namespace dovetail {

/// What happened at one depth of the recursion.
struct SplitLevel {
  std::int64_t subproblems = 0;
  std::int64_t bottoms = 0;         ///< subproblems with few interior sites or none: the recursion ends there
  std::int64_t largest = 0;         ///< most interior sites of a subproblem
  std::int64_t interior = 0;        ///< interior sites of all subproblems
  std::int64_t bottom_interior = 0; ///< those of the bottoms among them
  std::int64_t border = 0;          ///< border sites of all subproblems, each as often as it is met
  std::int64_t path = 0;            ///< sites of all new paths, clipped
  std::int64_t longest_path = 0;
  /// Bucketing: the largest of the subproblems that are split over their mean; 1 is even.
  double bucketing() const {
    const std::int64_t split = interior - bottom_interior;
    return split > 0 ? static_cast<double>(largest * (subproblems - bottoms)) / static_cast<double>(split)
                     : 1.0;
  }
};

/// Where the time went.
struct SplitTimes {
  double sort_s = 0;   ///< presorting in x and in y
  double hull_s = 0;   ///< lower hulls
  double border_s = 0; ///< clipping, and dividing the borders
  double split_s = 0;  ///< dividing the two orders
  double bottom_s = 0; ///< triangulating borders without interior, and joining triangles
};

/// A record of one run or several, for studies.
struct SplitTrace {
  std::vector<SplitLevel> levels; ///< from the whole set downwards
  SplitTimes times;
};

/// The canonical Delaunay triangulation of distinct sites in any order, as `delaunay` gives it, with the
/// triangles in another order. Local. At most 2^31 / 6 sites, or an Error.
/// O(n log n) where paths are short, as they are for uniform sites: every level is linear in its sites and
/// borders (4 ns a site, measured up to 10^6). A border of k sites without interior takes expected O(k) if it
/// is convex, as for sites on a circle, and O(k log k) otherwise.
/// This run is added to `trace` if there is one, at the cost of reading the clock at every split.
Triangulation delaunay_by_split_paths(std::span<const Point> sites, SplitTrace *trace = nullptr);

} // namespace dovetail
