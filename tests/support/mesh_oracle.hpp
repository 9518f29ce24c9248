/// Distributed meshes made the slow way in one process, for tests of what reads, writes and judges them, and
/// for comparing the pipeline with: gift wrapping in place of divide and conquer, triangles sorted to slabs
/// by asking for their circumcenters one by one, every path as the lower hull of all sites. O(sites *
/// triangles).
#pragma once

#include "dovetail/distributed/mesh.hpp"

#include <array>
#include <vector>

namespace dovetail::oracle {

struct MeshRequest {
  int slabs = 1;
  Axis axis = Axis::x;
  int rank = 0; ///< whose slabs to keep
  int ranks = 1;
};

/// The canonical Delaunay triangulation of distinct sites: three site numbers a triangle, counter-clockwise.
std::vector<std::array<LocalIndex, 3>> wrap(const std::vector<Point> &sites);

/// The mesh of a table of points in any order, with duplicates; the lowest input index stands for a site.
DistributedMesh make_mesh(const PointTable &points, const MeshRequest &request);

/// The distinct points in the total order: site v of a mesh is element v.
std::vector<Point> sites_of(const PointTable &points, Axis axis);

/// The same from any triangles over these sites, counter-clockwise: for meshes that are wrong in one way and
/// right in all others. Neighbours are found by edges, the rest as in make_mesh.
DistributedMesh make_mesh_of(const PointTable &points,
                             const std::vector<std::array<LocalIndex, 3>> &triangles,
                             const MeshRequest &request);

/// n points with attributes "z" and "intensity" made from their index, and input indices 0, 1, ...
PointTable table_of(const std::vector<Point> &points);

/// Families of points. `random_points` has no structure; `lattice_points` has every tie there is, and
/// duplicates.
std::vector<Point> random_points(int count, unsigned seed);
std::vector<Point> lattice_points(int count, int side, unsigned seed);

} // namespace dovetail::oracle
