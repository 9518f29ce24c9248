/// The triangles along a straight line. Local; reads only.
///
/// (The straight walk of Devillers, Pion and Teillaud, Walking in a triangulation, 2002.)
#pragma once

#include "dovetail/mesh/triangulation.hpp"

#include <span>
#include <vector>

namespace dovetail {

/// All triangles whose interior the segment between two points meets, in the order in which it goes through
/// them. What runs along edges meets none. The points may be anywhere, as long as the border is convex; at a
/// border that is not, the walk ends. `hint`: any triangle, near the beginning if that is known; the mesh
/// must have one. A walk to the beginning (locate.hpp); from outside also the hull edges that are seen; then
/// three to seven orientations a triangle, and the stars of vertices that the segment goes through.
std::vector<LocalIndex> triangles_along(std::span<const Point> sites, const Triangulation &mesh, Point from,
                                        Point to, LocalIndex hint);

} // namespace dovetail
