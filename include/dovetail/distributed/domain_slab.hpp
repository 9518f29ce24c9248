/// Meshes of domains as meshes of one slab, which can be written, drawn and measured like any other, and
/// back. Local.
#pragma once

#include "dovetail/distributed/mesh.hpp"
#include "dovetail/mesh/domain.hpp"

#include <vector>

namespace dovetail {

/// What a slab knows of a domain's vertices beyond their places, in the order of the DomainMesh.
struct DomainVertices {
  std::vector<GlobalIndex> input_index;
  std::vector<Attribute> attributes; ///< "marker" is added
  std::vector<Duplicate> duplicates; ///< `site`: the vertex
};

/// The vertices come into the total order, and `record`, in the mesh's numbers, with them. Its
/// segment_of_side and region are taken from the mesh. O(n log n) for n vertices.
DistributedMesh slab_of_domain(DomainMesh mesh, DomainRecord record, DomainVertices vertices);

/// The mesh in its slab, with vertices in the slab's order. `mesh` has a domain and all of it is here.
DomainMesh domain_of_slab(const DistributedMesh &mesh);

} // namespace dovetail
