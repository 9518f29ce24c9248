/// The bottom of the split-path recursion: triangulating a border with few sites inside. Private to mesh.
#pragma once

#include "dovetail/mesh/triangulation.hpp"
#include "polygon_triangulation.hpp"
#include "presorted_sites.hpp"
#include "twin_sides.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace dovetail {

/// Triangulates what closed walks along Delaunay edges enclose.
class BorderTriangulation {
public:
  BorderTriangulation(std::span<const Point> sites, Triangulation &mesh)
      : sites_(sites), twins_(sites.size(), mesh), long_(sites), place_(sites.size(), none) {}

  /// With sites inside, no walk may be longer.
  static constexpr std::size_t longest_around_sites = 64;

  /// On entry: a walk of vertices, counter-clockwise around what it encloses, its end being next to its
  /// beginning; pinched walks meet a vertex or an edge again, and never enclose anything twice. `inside` are
  /// the sites that it encloses. Adds all triangles inside to the mesh, next to those that are there already.
  /// Without sites inside expected O(k) for a walk of k vertices around convex polygons, and O(k log k)
  /// around others; with sites inside O(k^2), k being all of them.
  void solve(std::span<const LocalIndex> walk, std::span<const RankedSite> inside);

  /// When all is solved.
  void finish() { twins_.finish(); }

private:
  void solve_simple(std::span<const LocalIndex> polygon);
  void solve_long(std::span<const LocalIndex> polygon);
  LocalIndex solve_by_search(std::size_t begin);
  std::size_t apex(std::size_t begin) const;

  /// What searches read, one after another.
  struct Corner {
    Point point;
    LocalIndex vertex;
  };
  Corner corner(LocalIndex v) const { return {sites_[static_cast<std::size_t>(v)], v}; }

  std::span<const Point> sites_;
  TwinSides twins_;
  PolygonTriangulation long_;
  std::vector<LocalIndex> place_; ///< of a vertex on the walk that is open; `none` elsewhere
  std::vector<LocalIndex> open_;
  std::vector<Corner> inside_;  ///< the sites inside that no triangle has yet
  std::vector<Corner> polygon_; ///< a stack of the polygons being solved by search
  std::vector<LocalIndex> corners_;
};

} // namespace dovetail
