/// The sort for points that do not fit into memory: the same slabs as sort_into_slabs, left on disk.
///
/// A first reading takes a sample (which also chooses the axis) whose quantiles cut the plane into buckets of
/// a fraction of the memory; ranks own consecutive buckets. A second reading sends every point to the owner
/// of its bucket, in rounds of bounded size, where it waits on disk. Then each bucket is sorted in memory and
/// its equal points are merged: from there on the number of distinct sites before any place is known, slabs
/// are cut at exact positions, and what lies on the wrong side of a border between ranks is sent across. A
/// bucket that is too large, because the sample did not see how dense it is, is cut in the same way once
/// more.
#pragma once

#include "dovetail/base/point_table.hpp"
#include "dovetail/comm/communicator.hpp"
#include "dovetail/distributed/slabs.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace dovetail {

/// This rank's points, piece by piece, twice: only at the second time are input indices right. Local, but for
/// begin_again.
class PointStream {
public:
  virtual ~PointStream() = default;
  virtual const std::vector<std::string> &attribute_names() const = 0;
  /// Replaces the rows of `table`, which has the attributes, by the next points, at most `most` or few more;
  /// false if there are none. Each time the same pieces. -0.0 is 0.0; coordinates and z are finite.
  virtual bool next(std::size_t most, PointTable &table) = 0;
  /// Collective.
  virtual void begin_again() = 0;
};

struct DiskSort {
  std::string folder;              ///< for scratch; every rank may have its own
  std::int64_t memory_bytes = 0;   ///< that this rank may use besides what it has in use already
  GlobalIndex most_slab_sites = 0; ///< where the number of slabs is chosen: not more sites in one; 0: any
};

/// Collective. The same as sort_into_slabs of the same points, whose errors it has, but for where sites and
/// duplicates are. Errors besides: scratch that cannot be written or read (output); more points at one
/// position than fit into memory (resource); `presorted` (usage). Disk: twice 24 bytes and 8 for every
/// attribute a point, of which half is given back bucket by bucket.
Slabs sort_on_disk(const Communicator &comm, PointStream &points, const SlabOptions &options,
                   const DiskSort &disk);

} // namespace dovetail
