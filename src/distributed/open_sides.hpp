/// The sides of a slab's triangles that have no neighbour in the slab: on a border or on the hull. Local.
#pragma once

#include "dovetail/distributed/mesh.hpp"
#include "dovetail/mesh/half_edge.hpp"

#include <span>
#include <vector>

namespace dovetail {

/// All of them, ascending, as 3 * triangle + i. One pass over the neighbours.
std::vector<LocalIndex> open_sides(const Triangulation &triangles);

/// The same for whoever knows `some`: follows the boundary from them, around each of its vertices, and so
/// sees the triangles there alone. Complete if every piece of the slab has one of `some` on its boundary,
/// which is then one cycle.
std::vector<LocalIndex> open_sides_around(const Triangulation &triangles, std::span<const LocalIndex> some);

/// The same of a slab whose border sides are known.
std::vector<LocalIndex> open_sides(const SlabMesh &slab);

/// The twin of a side, or `none`, in triangles that nobody has checked: whose neighbour does not have the
/// same edge with this triangle beyond is an Error (input).
HalfEdge sound_twin(const Triangulation &triangles, HalfEdge h);

/// The open side that begins where the open side h ends, and the one that ends where it begins. As hull_after
/// and hull_before, for triangles that nobody has checked: an Error (input) if neighbours do not agree, or
/// never end around a vertex.
HalfEdge open_side_after(const Triangulation &triangles, HalfEdge h);
HalfEdge open_side_before(const Triangulation &triangles, HalfEdge h);

} // namespace dovetail
