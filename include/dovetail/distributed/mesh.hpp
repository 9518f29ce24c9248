/// A triangulation spread over ranks: slabs of sites, each with the triangles whose circumcenter it holds.
#pragma once

#include "dovetail/base/point_table.hpp"
#include "dovetail/mesh/domain_record.hpp"
#include "dovetail/mesh/triangulation.hpp"

#include <cassert>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dovetail {

/// Side `side` = 3 * triangle + i of a slab's triangle has its neighbour in another slab.
struct BorderSide {
  LocalIndex side;
  GlobalIndex neighbour; ///< global number of the triangle beyond
};

/// One slab. Vertices 0 .. own_count - 1 are its own sites in the total order; after them come its ghosts,
/// the sites of its two paths that its triangles use and that belong to other slabs, by ascending global
/// number.
struct SlabMesh {
  LocalIndex own_count = 0;
  GlobalIndex first_site = 0;            ///< own vertex v has the global number first_site + v
  GlobalIndex first_triangle = 0;        ///< triangle t has the global number first_triangle + t
  PointTable vertices;                   ///< own, then ghosts: points, input indices, attributes
  std::vector<GlobalIndex> ghost_number; ///< global numbers of the ghosts
  Triangulation triangles;               ///< neighbour `none`: on a border (see border_sides) or the hull
  std::vector<BorderSide> border_sides;  ///< by ascending side; a `none` side not listed is on the hull
  std::vector<GlobalIndex> left_path; ///< global site numbers of the complete path of the slab's left line,
                                      ///< ascending along the line; empty for slab 0
};

/// Digest of the input that a mesh was made from.
struct InputDigest {
  GlobalIndex points = 0;
  std::uint64_t hash = 0; ///< sum of digest_of_point over all points, duplicates included
};

/// What it took to make a mesh, the same on all ranks. All zero in a mesh that was read from a file.
struct MeshStatistics {
  GlobalIndex own_sites_max = 0;       ///< most sites that a rank owns
  GlobalIndex path_sites_max = 0;      ///< most path sites that a rank holds, all its paths added up
  GlobalIndex candidate_sites_max = 0; ///< most sites that came together on a rank to make one path
  GlobalIndex slab_sites_min = 0;
  GlobalIndex slab_sites_max = 0;
  GlobalIndex path_sites = 0; ///< of all lines, each path once
  GlobalIndex longest_path = 0;
  GlobalIndex ghosts = 0; ///< of all slabs

  /// The largest slab over the mean one; 1 is even.
  double slab_imbalance(GlobalIndex sites, int slabs) const {
    return sites > 0 ? static_cast<double>(slab_sites_max) * slabs / static_cast<double>(sites) : 1.0;
  }
};

/// What is the same on all ranks, and this rank's consecutive slabs.
struct DistributedMesh {
  Axis axis = Axis::x;
  std::vector<GlobalIndex> site_offsets{0}; ///< slab s owns sites site_offsets[s] .. site_offsets[s + 1] - 1
  std::vector<GlobalIndex> triangle_offsets{0}; ///< likewise its triangles
  std::vector<double> lines; ///< lines[s - 1] bounds slab s on its left; slab_count - 1 of them
  GlobalIndex hull_edges = 0;
  std::uint64_t checksum = 0;
  InputDigest digest;
  std::vector<CoordinateSystemRecord> coordinate_system; ///< of the input, carried along
  MeshStatistics statistics;
  /// A mesh of a domain, on one slab; its boundary is that of the domain, and hull_edges counts it. Without:
  /// the Delaunay triangulation of all sites.
  std::optional<DomainRecord> domain;

  int first_slab = 0;                ///< number of slabs.front()
  std::vector<SlabMesh> slabs;       ///< this rank's
  std::vector<Duplicate> duplicates; ///< of this rank's own sites, by ascending (site, input_index)

  int slab_count() const { return static_cast<int>(site_offsets.size()) - 1; }
  GlobalIndex site_count() const { return site_offsets.back(); }
  GlobalIndex triangle_count() const { return triangle_offsets.back(); }
};

/// Of the mesh of a domain.
inline const DomainRecord &record_of(const DistributedMesh &mesh) {
  assert(mesh.domain);
  return *mesh.domain;
}

/// First slab of rank `rank`, when `slabs` of them are spread over `ranks`; the last rank's end with `slabs`.
constexpr int first_slab_of_rank(int slabs, int rank, int ranks) {
  return static_cast<int>(static_cast<std::int64_t>(slabs) * rank / ranks);
}

} // namespace dovetail
