/// The points that a mesh was made from, numbered in the order of the input. Private to io.
#pragma once

#include "dovetail/comm/communicator.hpp"
#include "dovetail/distributed/mesh.hpp"

#include <string>
#include <vector>

namespace dovetail {

/// Node i is the i-th of all points taken, counted from 0 in the order of the input, merged duplicates
/// included. That is the input index as long as all records were taken, and less than it behind LAS records
/// that were skipped, since the numbers have no gaps.
class NodeNumbers {
public:
  /// Collective. Where input indices have gaps, the rank that owns a range of them ranks those of its range:
  /// 8 bytes a vertex, and two exchanges. `path` is for errors (input): indices that are no indices, or of
  /// which two are equal.
  NodeNumbers(const Communicator &comm, const DistributedMesh &mesh, const std::string &path);

  GlobalIndex count() const { return count_; }
  /// Of vertex v of this rank's k-th slab, which may be a ghost.
  GlobalIndex of_vertex(std::size_t k, LocalIndex v) const {
    const auto i = static_cast<std::size_t>(v);
    return has_gaps_ ? numbers_[first_of_slab_[k] + i] : mesh_.slabs[k].vertices.input_index[i];
  }
  /// Of this rank's d-th duplicate.
  GlobalIndex of_duplicate(std::size_t d) const {
    return has_gaps_ ? numbers_[first_of_slab_.back() + d] : mesh_.duplicates[d].input_index;
  }

private:
  void check_and_count(const Communicator &comm, const std::string &path);
  void number(const Communicator &comm, const std::string &path);

  const DistributedMesh &mesh_;
  GlobalIndex count_ = 0;
  GlobalIndex end_index_ = 0; ///< one more than the largest input index
  bool has_gaps_ = false;
  std::vector<GlobalIndex> numbers_; ///< with gaps: of all vertices, slab by slab, then of all duplicates
  std::vector<std::size_t> first_of_slab_; ///< where a slab's are, and at the end the duplicates'
};

} // namespace dovetail
