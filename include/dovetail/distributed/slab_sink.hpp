/// Where slabs go that are not kept: a mesh file, say, which is filled slab by slab.
///
/// All places in the file are known before any triangle exists (F9 in include/dovetail/README.md), so slabs
/// may come in any order and from any rank. What a slab cannot know by itself, the triangles beyond its
/// borders and what came with its ghosts, follows when all ranks have finished.
#pragma once

#include "dovetail/comm/communicator.hpp"
#include "dovetail/distributed/mesh.hpp"

#include <span>
#include <string>
#include <vector>

namespace dovetail {

/// The sizes of a mesh and all that is short in it; the same on all ranks, but for first_slab and own_slabs.
struct MeshOutline {
  /// No slabs; checksum and hull_edges may still be missing.
  DistributedMesh mesh;
  std::vector<std::string> attribute_names;
  std::vector<GlobalIndex> vertex_offsets{0};    ///< slab s has so many vertices, ghosts included
  std::vector<GlobalIndex> path_offsets{0};      ///< and so many sites on its left path
  std::vector<GlobalIndex> duplicate_offsets{0}; ///< and so many duplicates of its own sites
  int own_slabs = 0;                             ///< of this rank, from mesh.first_slab on
};

class SlabSink {
public:
  virtual ~SlabSink() = default;

  /// Collective. First of all.
  virtual void begin(const Communicator &comm, const MeshOutline &outline) = 0;
  /// Local. One of this rank's slabs, each once, with the duplicates of its sites. Columns of `vertices` that
  /// end with the own sites, and neighbours that are `none` without being on the hull, are completed later.
  virtual void take(int slab, const SlabMesh &mesh, std::span<const Duplicate> duplicates) = 0;
  /// Local. What was missing of that slab: `border.border_sides`, and in `border.vertices` input indices and
  /// attributes of the ghosts alone.
  virtual void complete(int slab, const SlabMesh &border) = 0;
  /// Collective. Last of all.
  virtual void finish(std::uint64_t checksum, GlobalIndex hull_edges) = 0;
};

} // namespace dovetail
