/// Canonical Delaunay triangulation of one process's points by divide and conquer with cuts across the longer
/// side (Guibas and Stolfi, Primitives for the manipulation of general subdivisions, 1985; Dwyer, A faster
/// divide-and-conquer algorithm for constructing Delaunay triangulations, 1987; ghost triangles as in
/// Shewchuk, Triangle, 1996).
///
/// How it works is told in src/mesh, to be read in this order: sphere.hpp (the data structure), merge.hpp
/// (the merge), sight.hpp (its filter), smallest_parts.hpp (where recursion ends), bucket.hpp and
/// median_tree.hpp (the cuts), divide_and_conquer.cpp (all of it together). Of 1000 instructions a point on
/// uniform sites, sorting and cutting take about 280, parts of four 60, tangents 50, zips 470, and the arrays
/// of the result 140, of which setting them to zero, which vectors insist on, is 50. `tools/bench count`
/// counts again.
#pragma once

#include "dovetail/mesh/triangulation.hpp"

#include <cstddef>

namespace dovetail {

/// Six half-edges a site, ghosts included, are numbered by LocalIndex.
inline constexpr std::size_t most_delaunay_sites = (std::size_t{1} << 31) / 6;

/// The canonical Delaunay triangulation of distinct sites in any order. Local.
/// No triangles if all sites are collinear. The order of triangles and which corner comes first depend on the
/// sites and their order alone. Sites must be distinct; more than most_delaunay_sites are an Error
/// (resource). O(n log n), with expected O(n) work in merges for uniform sites; 48 bytes a site for the
/// result, and about a megabyte while it works.
Triangulation delaunay(std::span<const Point> sites);

} // namespace dovetail
