/// Sites added to a mesh, in place: the canonical Delaunay triangulation of the sites becomes that of more
/// sites, whatever made it, and in whatever order they come. Local.
///
/// In the mesh all sites are vertices, numbered as in `sites`; new ones get the numbers that follow. While
/// all sites are collinear there are no triangles. (Guibas and Stolfi, Primitives for the manipulation of
/// general subdivisions, 1985; cavities: cavity.hpp; the same by flips: flip.hpp.)
#pragma once

#include "dovetail/mesh/cavity.hpp"

#include <span>
#include <vector>

namespace dovetail {

struct Insertion {
  LocalIndex vertex;   ///< the new site, or the one that equals it
  LocalIndex triangle; ///< one of its triangles: a hint for what lies near; `none` while there are none
  bool is_new;
};

/// Adds one site. `hint` is any triangle, or `none`: then the walk begins at the nearest of a sample
/// (`jump`). The walk (locate.hpp) and the cavity (cavity.hpp), which is O(1) on average in random order, or,
/// while all sites are collinear, O(sites). More sites than most_delaunay_sites are an Error (resource).
Insertion insert(std::vector<Point> &sites, Triangulation &mesh, Point site, LocalIndex hint, Cavity &memory);

/// Adds a batch, in the order of `space_filling_order` and each with a triangle of the last one as a hint,
/// that which faces it. Returns the vertex of every point, in the order given. New vertices are numbered as
/// they come in, so that near ones lie near in memory; a point that equals a site, or an earlier one that was
/// inserted, gets its number and is no new one. O(1) on average a point, once ordered; memory is reserved for
/// all of them at once.
std::vector<LocalIndex> insert_batch(std::vector<Point> &sites, Triangulation &mesh,
                                     std::span<const Point> points);

/// The same in the order given.
std::vector<LocalIndex> insert_in_order(std::vector<Point> &sites, Triangulation &mesh,
                                        std::span<const Point> points);

/// A triangle near a point without knowing the mesh (jump and walk: Mücke, Saias and Zhu, Fast randomized
/// point location without preprocessing, 1996): of the cube root of n triangles, evenly spread over the
/// numbers, that with the nearest first corner. The walk from there takes O(n^(1/3)) steps for random sites.
/// The mesh must have a triangle.
LocalIndex jump(std::span<const Point> sites, const Triangulation &mesh, Point point);

} // namespace dovetail
