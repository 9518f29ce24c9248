/// Sets too large for memory, seen through a sample of their slabs. Statistical: the points are those of no
/// run, but have the same distribution.
#pragma once

#include "dovetail/base/types.hpp"
#include "dovetail/geometry/distributions.hpp"

#include <cstdint>
#include <vector>

namespace dovetail::virtual_ranks {

/// A set of points that exists slab by slab: slab s of N has the points between the s-th and the next of the
/// N-quantiles of `across`, n / N of them, independent of each other and of those of other slabs. (In a set
/// of n independent points the s-th border varies about its quantile by 1 / sqrt(n).)
class SlabwiseSet {
public:
  /// uniform, normal, kuzmin or line; every slab with the same number of points. Throws
  /// std::invalid_argument.
  SlabwiseSet(const SyntheticSet &set, int slabs);

  /// Along which sort_into_slabs would cut.
  Axis axis() const { return set_.distribution == Distribution::line ? Axis::y : Axis::x; }
  GlobalIndex points_of_slab() const { return set_.n / slabs_; }
  int slabs() const { return slabs_; }

  /// In the total order. The same for every call. O(points).
  std::vector<Point> slab(int number) const;

private:
  SyntheticSet set_;
  int slabs_;
};

/// What a sample of slabs shows.
struct SampledRun {
  int sampled_slabs = 0;
  GlobalIndex longest_path = 0;
  GlobalIndex path_sites_max = 0; ///< both paths of a slab
  double mean_path = 0;           ///< of a line between slabs
  double mean_ghosts = 0;         ///< of a slab
  double hull_max_s = 0;          ///< processor time for the two own hulls of a slab; of all slabs
  double hull_mean_s = 0;
  double triangulate_max_s = 0; ///< processor time for a slab with its paths
  double triangulate_mean_s = 0;
};

/// Takes own hulls of all slabs, their paths by scanning (F6'), and the triangles of `sample` slabs and of
/// the outermost and the middle ones. The count of triangles that a slab's paths foretell is checked.
SampledRun run_sampled(const SlabwiseSet &set, int sample);

} // namespace dovetail::virtual_ranks
