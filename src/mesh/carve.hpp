/// What of a constrained triangulation of the convex hull belongs to the domain. Private to mesh.
#pragma once

#include "dovetail/mesh/constrain.hpp"
#include "faces.hpp"

#include <span>
#include <vector>

namespace dovetail {

/// Marks the faces that are outside, by the graph's rules: reached from beyond the hull without crossing a
/// segment, or, with even_odd, by crossing an even number of them at the least, not counting lines. Linear.
void mark_outside(const PlanarGraph &graph, Faces &faces);

/// Marks the faces that are reached from seeds without crossing a segment. A seed that has no effect is
/// returned. Linear, and a walk for each seed.
std::vector<StraySeed> mark_holes(std::span<const Point> vertices, std::span<const Point> holes,
                                  Faces &faces);

/// Numbers the unmarked faces by their region's seed. As mark_holes.
std::vector<StraySeed> number_regions(std::span<const Point> vertices, std::span<const RegionSeed> regions,
                                      Faces &faces);

} // namespace dovetail
