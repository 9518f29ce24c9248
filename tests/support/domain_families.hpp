/// Planar straight-line graphs of the kinds that break mesh generators, all in order.
#pragma once

#include "dovetail/mesh/domain.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace dovetail::testing {

struct NamedGraph {
  std::string name;
  PlanarGraph graph;
};

/// A bar with teeth of unit height, `gap` apart.
PlanarGraph comb(int teeth, double gap);
/// Spikes around a centre, each with this angle at its tip, degrees.
PlanarGraph star(int spikes, double degrees);
/// Segments from one vertex to all sides, the first two with this angle between them, in a square.
PlanarGraph fan(int segments, double degrees);
/// A square with pairs of parallel segments inside, a small distance apart.
PlanarGraph slits(int pairs, double gap);
/// Squares in squares, by even-odd nesting: rings of domain and rings of holes, nearly touching.
PlanarGraph nested(int depth, double gap);
PlanarGraph regular_polygon(int sides);
/// Random segments in a square, some of which share ends, none of which cross.
PlanarGraph random_segments(int tries, std::uint64_t seed);
/// Everything that much farther from the origin.
PlanarGraph shifted(PlanarGraph graph, double by);

/// One or more of each, small enough for every test.
std::vector<NamedGraph> domain_families();

} // namespace dovetail::testing
