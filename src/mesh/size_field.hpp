/// How long edges may be at the vertices of a mesh that is to be refined. Private to mesh.
#pragma once

#include "faces.hpp"

#include <span>
#include <vector>

namespace dovetail {

/// Of each vertex the least, over all vertices, of the local feature there and growth times the way from
/// there along edges. The local feature is the length of the shortest edge of a vertex, or its distance from
/// the opposite side of a triangle, if that is a segment and nearer. HUGE_VAL in no triangle. O(n log n).
std::vector<double> local_sizes(std::span<const Point> vertices, const Faces &faces, double growth);

} // namespace dovetail
