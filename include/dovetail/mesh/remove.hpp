/// Sites taken out of a mesh, in place: what is left is the canonical Delaunay triangulation of the other
/// sites. Local.
///
/// The hole that the star of a site leaves is filled by Delaunay triangles of the link. Every edge of the
/// link is Delaunay without the site too, so the triangle at an edge of the hole is that of the link vertex
/// from which the circle through the edge holds no other; it leaves two smaller holes of the same kind. At a
/// site on the hull the hole is open: first the hull of the link is closed over it. (Devillers, On deletion
/// in Delaunay triangulations, 2002, compares ways to find the triangles; for the six edges of a mean link
/// this one does as well as any.)
///
/// Numbers stay dense, so the last triangles move into slots that become free, and so does a site.
#pragma once

#include "dovetail/mesh/star.hpp"

#include <span>
#include <vector>

namespace dovetail {

/// What removals work with: keep one and pass it again.
struct RemovalMemory {
  struct Hole {
    LocalIndex first, last; ///< places in `link`
    HalfEdge outside;       ///< of the edge from link[last] to link[first]; `none` on the hull
  };
  Star star;
  std::vector<LocalIndex> slots; ///< of the star's triangles, ascending
  std::vector<LocalIndex> link;  ///< vertices, counter-clockwise around the site; closed: the first again
  std::vector<HalfEdge> beyond;  ///< of the edge from link[i] to link[i + 1], outside of the star
  std::vector<LocalIndex> hull;  ///< places in `link`
  std::vector<Hole> holes;
  std::vector<LocalIndex> triangles_moved; ///< by the last removal, in this order: from, to, from, to, ...
};

struct Removal {
  LocalIndex triangle; ///< one that was next to the site: a hint for what lies near; `none` if none are left
  LocalIndex moved;    ///< the site that had the last number and has that of the removed one now, or `none`
};

/// Removes one site. `hint` is any triangle, or `none` (as for `insert`). Two walks (locate.hpp), to the site
/// and to the one with the last number; and for a link of d edges, six on average, O(d log d) where the
/// triangles found divide it evenly, O(d^2) at worst.
Removal remove(std::vector<Point> &sites, Triangulation &mesh, LocalIndex vertex, LocalIndex hint,
               RemovalMemory &memory);

/// Removes several distinct sites; the others keep their order. Returns the new number of every site, `none`
/// for those that are gone. O(1) on average a removed site, and O(1) a site and triangle of the mesh to
/// number them anew.
std::vector<LocalIndex> remove_batch(std::vector<Point> &sites, Triangulation &mesh,
                                     std::span<const LocalIndex> vertices);

} // namespace dovetail
