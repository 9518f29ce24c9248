/// Canonical Delaunay triangulation of one process's points by divide and conquer with alternating cuts
/// (Guibas and Stolfi 1985, Dwyer 1987).
#pragma once

#include "dovetail/mesh/triangulation.hpp"

namespace dovetail {

/// The canonical Delaunay triangulation of distinct sites in any order. Local.
/// No triangles if all sites are collinear. The order of triangles and which corner comes first depend on the
/// sites and their order alone. Sites must be distinct and at most 2^31 / 6. O(n log n); expected O(n) work
/// in merges for uniform sites.
Triangulation delaunay(std::span<const Point> sites);

} // namespace dovetail
