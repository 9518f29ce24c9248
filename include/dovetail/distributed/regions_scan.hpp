/// Paths of several consecutive slabs in one process by a forward and a backward scan (F6' in
/// include/dovetail/README.md): every site is read once, and all else works on short chains. Local.
#pragma once

#include "dovetail/distributed/slabs.hpp"
#include "dovetail/geometry/split_path.hpp"

#include <vector>

namespace dovetail {

/// For every own slab, the only ones of its sites that can be on a path at or beyond its border: right[k] is
/// the path of slab k's own sites alone at its right line, left[k] at its left line. Empty where there is no
/// such line, outside the first and the last slab of all.
struct SlabHulls {
  std::vector<Path> left;
  std::vector<Path> right;
};

SlabHulls slab_hulls(const Slabs &slabs);

/// chains[k] is the path, at the right line of own slab k, of the sites `before` and those of own slabs
/// 0 .. k. `before` must be all of a set left of these slabs that can be on any such path. Empty for the last
/// slab of all.
std::vector<Path> forward_scan(const Slabs &slabs, const SlabHulls &hulls, const Path &before);

/// chains[k] is the path, at the left line of own slab k, of the sites `after` and those of own slabs k and
/// up. Empty for slab 0.
std::vector<Path> backward_scan(const Slabs &slabs, const SlabHulls &hulls, const Path &after);

/// All paths of the own slabs, as in Region::paths, from those of the leftmost and the rightmost line. O(sum
/// of the lengths of all hulls and paths).
std::vector<Path> scan_paths(const Slabs &slabs, const SlabHulls &hulls, const Path &leftmost,
                             const Path &rightmost);

} // namespace dovetail
