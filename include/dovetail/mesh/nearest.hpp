/// The site nearest to a point. Local; reads only.
#pragma once

#include "dovetail/mesh/triangulation.hpp"

#include <span>

namespace dovetail {

/// Of two at equal distances the one of greater x, of equal x that of greater y. `hint` is any triangle, or
/// `none`: then the walk begins at `jump` (insert.hpp). There must be a site.
///
/// A site that is not the nearest has a neighbour that is nearer, and nearer ones are followed from a corner
/// of where the point lies: for one near, O(1) on average. In a mesh without triangles O(sites).
LocalIndex nearest_site(std::span<const Point> sites, const Triangulation &mesh, Point point,
                        LocalIndex hint);

} // namespace dovetail
