/// From sorted slabs to regions: every slab learns the two split paths that bound it.
///
/// A group of ranks owns consecutive slabs and the two paths around them. It splits at the rank border
/// nearest to the median of its sites: the path of that line goes to the whole group, the group's
/// communicator is split in two, and the halves never speak to each other again until they are stitched. What
/// is left to a single rank it settles by itself, scanning its slabs forwards and backwards.
///
/// G. E. Blelloch, G. L. Miller, D. Talmor: Developing a practical projection-based parallel Delaunay
/// algorithm, 1996. What is new is the pruning (F6 in include/dovetail/README.md): nobody ever looks at all
/// the sites of a group, only at short chains of them.
#pragma once

#include "dovetail/base/error.hpp"
#include "dovetail/comm/communicator.hpp"
#include "dovetail/distributed/slabs.hpp"
#include "dovetail/geometry/split_path.hpp"

#include <optional>
#include <vector>

namespace dovetail {

/// This rank's consecutive slabs and the paths around them: all that its triangles can depend on.
struct Region {
  Slabs slabs;
  /// paths[k] is the complete path of the line left of own slab k, paths[k + 1] of the line right of it; for
  /// k = 0 .. own slabs. There is no line, and the path is empty, outside the first and the last slab of all.
  std::vector<Path> paths;
  /// The most sites that came together here for making one path: candidates of other ranks, with the path
  /// that let them through.
  GlobalIndex candidate_sites = 0;
  /// What went wrong on this rank, or in a group that it was in, while others went on: `triangulate_region`
  /// throws it, so that it can be agreed on when halves may speak again.
  std::optional<Problem> problem;
};

/// Collective over `comm`, on which the slabs are spread. Reads every site once, for the hulls of its slab at
/// its two borders, and then works on chains only: O(sqrt n) sites each, if they are uniform. About
/// log2(ranks) splits, each of a gather, two broadcasts and a split of the communicator.
Region split_into_regions(const Communicator &comm, Slabs &&slabs);

} // namespace dovetail
