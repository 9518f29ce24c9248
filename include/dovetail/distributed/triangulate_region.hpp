/// The triangles of a rank's own slabs, without a word to anyone.
///
/// A slab is one ordinary triangulation (F4 in include/dovetail/README.md): that of its own sites and those
/// of its two paths, of which it keeps exactly the triangles with their circumcenter right of the left line
/// and not right of the right one. Local.
#pragma once

#include "dovetail/base/progress.hpp"
#include "dovetail/distributed/kernel.hpp"
#include "dovetail/distributed/mesh.hpp"
#include "dovetail/distributed/regions.hpp"

#include <optional>
#include <span>
#include <vector>

namespace dovetail {

/// Slabs that do not know their neighbours yet. Of `mesh` this is still missing: triangle_offsets,
/// hull_edges and statistics; the checksum is that of the own slabs; and in the slabs first_triangle,
/// border_sides, and of ghosts input indices and attributes (whose columns are as long as the own sites
/// only).
struct UnstitchedMesh {
  DistributedMesh mesh;
  /// Of every own slab the sides 3 * triangle + i without a neighbour in the slab, ascending: each is either
  /// on a border or on the hull.
  std::vector<std::vector<LocalIndex>> open_sides;
  GlobalIndex path_sites = 0;      ///< on all paths that this rank holds
  GlobalIndex candidate_sites = 0; ///< see Region
};

/// A slab alone: what UnstitchedMesh says of one.
struct LoneSlab {
  SlabMesh mesh;
  std::vector<LocalIndex> open_sides;
  std::uint64_t checksum = 0;
};

/// Local. Own slab k of a region without a problem. Errors and cost as below.
LoneSlab triangulate_slab(const Region &region, int k, const KernelChoice &kernel = {});

/// Local. Errors: the region's own problem; fault, if a slab has not the triangles that F9 foretells;
/// resource, if a slab with its paths has too many sites for local indices. Cost: the kernel's, and two
/// passes over its triangles.
UnstitchedMesh triangulate_region(Region &&region, const Progress &progress = {},
                                  const KernelChoice &kernel = {});

/// What a slab will have, before any of it exists.
struct SlabCounts {
  GlobalIndex triangles = 0;
  GlobalIndex ghosts = 0; ///< sites of other slabs that its triangles use
  friend bool operator==(const SlabCounts &, const SlabCounts &) = default;
};

/// F9: from a slab's own sites, in the total order, and its two paths, an empty one meaning that the slab is
/// outermost there. A path site is used unless the slab is nothing on both sides of it, that is, unless all
/// edges of the chains that end at it are on both of them. Local. O(path sites * log) and, for an outermost
/// slab or one whose paths end apart, two comparisons a site.
SlabCounts counts_between(std::span<const Point> own_sites, GlobalIndex first_site, const Path &left,
                          const Path &right, Axis axis);
/// The triangles of these; takes half as long without ghosts.
GlobalIndex triangles_between(std::span<const Point> own_sites, GlobalIndex first_site, const Path &left,
                              const Path &right, Axis axis);

/// Takes the triangles out for which `removed` lists the numbers, ascending; those at the end fill the gaps.
/// Neighbours of what is gone become `none`. Local. O(removed).
void remove_triangles(Triangulation &triangles, std::span<const LocalIndex> removed);

} // namespace dovetail
