/// What the parts of the insertion into a distributed mesh share. Private to distributed.
#pragma once

#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/exchange.hpp"
#include "dovetail/distributed/insert.hpp"
#include "dovetail/distributed/mesh.hpp"
#include "dovetail/distributed/ownership.hpp"
#include "dovetail/geometry/split_path.hpp"
#include "slab_lines.hpp"

#include <algorithm>
#include <span>
#include <string>
#include <vector>

namespace dovetail::insertion {

template <class T> std::size_t at(T index) { return static_cast<std::size_t>(index); }

/// That the mesh is not what it says, found on the way. `place`: where. Who knows the mesh's name adds it.
[[noreturn]] void refuse_mesh(std::string place, std::string what);

/// The new sites of a slab among its own: site j comes behind places[j] of the old ones, so it becomes own
/// site places[j] + j.
struct SlabArrivals {
  std::span<const LocalIndex> places; ///< ascending
  /// What the old own site v becomes. O(log places).
  LocalIndex place_of_old(LocalIndex v) const {
    return v + static_cast<LocalIndex>(std::ranges::upper_bound(places, v) - places.begin());
  }
  LocalIndex place_of_new(std::size_t j) const { return places[j] + static_cast<LocalIndex>(j); }
};

/// The new sites of this rank's slabs: distinct, none of them a site of the mesh, in the total order.
struct Placement {
  PointTable sites;                      ///< with the attributes of the mesh
  std::vector<std::size_t> begins;       ///< own slab k has sites begins[k] .. begins[k + 1] - 1
  std::vector<LocalIndex> places;        ///< see SlabArrivals
  std::vector<GlobalIndex> site_offsets; ///< of all slabs, as they will be

  std::size_t count(std::size_t k) const { return begins[k + 1] - begins[k]; }
  std::span<const Point> points(std::size_t k) const {
    return std::span(sites.points).subspan(begins[k], count(k));
  }
  SlabArrivals arrivals(std::size_t k) const { return {std::span(places).subspan(begins[k], count(k))}; }
};

/// Collective. Gives the mesh the attributes of the points that it has not, and the points those of the mesh:
/// the same names in the same order on both sides. Where there is no value, z is 0 and all others are NaN.
void unify_attributes(const Communicator &comm, DistributedMesh &mesh, PointTable &points,
                      InsertStatistics &statistics);

/// Collective. Brings points to the slabs that they lie in and finds which are new sites. What equals a site
/// or another point becomes a duplicate, or its site's representative, by the rule. Of the mesh changes:
/// duplicates (with the numbers that sites will have), digest, input index and attributes of sites that are
/// represented anew. Lines stay.
Placement place_points(const Communicator &comm, PointTable &&points, const InsertOptions &options,
                       DistributedMesh &mesh);

/// The paths around a slab before and after, with the numbers that sites will have; empty where there is no
/// line.
struct SlabPaths {
  Path old_left, old_right, left, right;
  bool changed() const { return old_left != left || old_right != right; }
};

struct PathUpdate {
  std::vector<SlabPaths> slabs;    ///< this rank's
  GlobalIndex candidate_sites = 0; ///< as in Region
};

/// Collective. The new path of a line is the hull of the old one and the new sites; what is not near to the
/// line does not travel (split_into_regions). Ghosts get the numbers that their sites will have.
PathUpdate update_paths(const Communicator &comm, const Placement &placement, DistributedMesh &mesh);

/// What a slab grows by.
struct Growth {
  const Placement &placement;
  int slab;               ///< among all
  std::size_t k;          ///< among own slabs
  const SlabPaths &paths; ///< around it
  const SlabLines &lines;
  Axis axis;
};

struct GrownSlab {
  std::vector<LocalIndex> open_sides; ///< of its triangles, ascending
  std::uint64_t checksum_change = 0;  ///< that of the slab after, less that before
};

/// Local. Inserts the slab's new sites and whatever its new paths bring, and keeps the triangles that are
/// between its lines. Own sites are in the total order again; ghosts lack what came with their sites.
GrownSlab grow_slab(SlabMesh &slab, const Growth &growth);

} // namespace dovetail::insertion
