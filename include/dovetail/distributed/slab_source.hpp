/// The slabs of a mesh one at a time, for whoever looks at each of them once and has not room for all.
#pragma once

#include "dovetail/distributed/mesh.hpp"

#include <cstddef>
#include <span>

namespace dovetail {

/// This rank's part of a mesh, given out piece by piece; what is given stays until the next call. Local.
class SlabSource {
public:
  virtual ~SlabSource() = default;

  /// What all ranks share, and first_slab. Its slabs and duplicates are nobody's business.
  virtual const DistributedMesh &common() const = 0;
  virtual int own_slab_count() const = 0;

  /// Own slab k, all of it.
  virtual const SlabMesh &slab(int k) = 0;
  /// What slab(k).vertices has: own sites, then ghosts.
  virtual const PointTable &vertices(int k) = 0;
  /// The ghosts of own slab k without its own sites: `vertices` and `ghost_number` are equally long.
  virtual SlabMesh ghosts(int k) = 0;
  /// Of the sites of own slab k. All parts together are the duplicates of the rank, in their order.
  virtual std::span<const Duplicate> duplicates(int k) = 0;
};

/// A mesh that is in memory already. It must live as long as this.
class SlabsInMemory : public SlabSource {
public:
  explicit SlabsInMemory(const DistributedMesh &mesh) : mesh_(mesh) {}
  const DistributedMesh &common() const override { return mesh_; }
  int own_slab_count() const override { return static_cast<int>(mesh_.slabs.size()); }
  const SlabMesh &slab(int k) override { return mesh_.slabs[static_cast<std::size_t>(k)]; }
  const PointTable &vertices(int k) override { return slab(k).vertices; }
  SlabMesh ghosts(int k) override;
  /// Entries that are out of order land in the part of some slab all the same.
  std::span<const Duplicate> duplicates(int k) override;

private:
  const DistributedMesh &mesh_;
};

} // namespace dovetail
