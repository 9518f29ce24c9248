/// Reading a mesh that is about to grow.
#pragma once

#include "dovetail/io/mesh.hpp"

namespace dovetail {

/// Collective. As read_mesh; the arrays of every slab get room for `growth` more vertices, those of its
/// paths, and their triangles. Such room takes no memory before it is used; without it, the first new
/// triangle would move all others.
DistributedMesh read_mesh_to_grow(const Communicator &comm, const std::string &path, GlobalIndex growth,
                                  const Progress &progress = {});

} // namespace dovetail
