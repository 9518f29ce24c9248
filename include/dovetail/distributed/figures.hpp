/// A mesh in figures: how its angles, areas, edges and degrees are distributed.
#pragma once

#include "dovetail/base/progress.hpp"
#include "dovetail/comm/communicator.hpp"
#include "dovetail/distributed/mesh.hpp"
#include "dovetail/mesh/histogram.hpp"

#include <vector>

namespace dovetail {

/// All counts are exact. Sums are made slab by slab and then in the order of the slabs, so that they depend
/// on the slabs but not on the ranks. What is beyond the range of doubles is infinite or zero.
struct MeshFigures {
  Histogram angles{even_bounds(0, 180, 10)};        ///< three a triangle, in degrees
  Histogram smallest_angles{even_bounds(0, 60, 5)}; ///< one a triangle
  Histogram areas{bounds_of_magnitudes()};          ///< of triangles
  Histogram edge_lengths{bounds_of_magnitudes()};   ///< every edge once
  Histogram degrees{even_bounds(0, 20, 1)};         ///< edges at every site; 19 and more share a bin
  double area = 0;                                  ///< of all triangles: of the convex hull
  double edge_length = 0;                           ///< of all edges together
  double hull_length = 0;
  GlobalIndex hull_edges = 0;
  std::vector<GlobalIndex> path_sites; ///< of the path of every line
  GlobalIndex duplicates = 0;
  GlobalIndex repeated_sites = 0;  ///< sites that have duplicates
  GlobalIndex most_duplicates = 0; ///< of one site
};

/// Collective; the same on all ranks, and for every number of them. The mesh must have a sound layout
/// (require_sound_layout). One pass over the triangles; ghosts' degrees travel to their owners.
/// `progress` hears of the stage "measure".
MeshFigures measure(const Communicator &comm, const DistributedMesh &mesh, const Progress &progress = {});

} // namespace dovetail
