#include "dovetail/distributed/stitch.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/exchange.hpp"
#include "dovetail/geometry/predicates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

namespace dovetail {
namespace stitching {

int Owners::rank_of_site(GlobalIndex number) const {
  const auto beyond = std::upper_bound(first_site.begin(), first_site.end(), number);
  return static_cast<int>(beyond - first_site.begin()) - 1;
}

Owners owners(const Communicator &comm, const DistributedMesh &mesh) {
  const GlobalIndex first = mesh.slabs.empty() ? none : mesh.slabs.front().first_site;
  Owners result{all_gather(comm, first)};
  result.first_site.push_back(mesh.site_count());
  // A rank without slabs begins where the next one does, and so owns nothing.
  for (std::size_t r = result.first_site.size() - 1; r-- > 0;)
    if (result.first_site[r] == none)
      result.first_site[r] = result.first_site[r + 1];
  return result;
}

void number_triangles(const Communicator &comm, DistributedMesh &mesh) {
  const auto counts = collectively(
      comm, [&] { return fmt::format("the table of {} slabs", mesh.slab_count()); },
      [&] {
        std::vector<GlobalIndex> own;
        own.reserve(mesh.slabs.size());
        for (const SlabMesh &slab : mesh.slabs)
          own.push_back(slab.triangles.triangle_count());
        return own;
      });
  const std::vector<GlobalIndex> of_slabs = all_gather_bulk<GlobalIndex>(comm, counts).data;
  collectively(
      comm, [&] { return fmt::format("the table of {} slabs", of_slabs.size()); },
      [&] {
        mesh.triangle_offsets.assign(of_slabs.size() + 1, 0);
        std::partial_sum(of_slabs.begin(), of_slabs.end(), mesh.triangle_offsets.begin() + 1);
      });
  for (std::size_t k = 0; k < mesh.slabs.size(); ++k)
    mesh.slabs[k].first_triangle = mesh.triangle_offsets[static_cast<std::size_t>(mesh.first_slab) + k];
}

} // namespace stitching

namespace {

/// Collective.
MeshStatistics statistics_of(const Communicator &comm, GlobalIndex all_path_sites,
                             GlobalIndex candidate_sites, const DistributedMesh &mesh) {
  GlobalIndex own = 0, path_sites = 0, longest = 0, ghosts = 0;
  for (const SlabMesh &slab : mesh.slabs) {
    own += slab.own_count;
    path_sites += static_cast<GlobalIndex>(slab.left_path.size());
    longest = std::max(longest, static_cast<GlobalIndex>(slab.left_path.size()));
    ghosts += static_cast<GlobalIndex>(slab.ghost_number.size());
  }
  const auto maxima = all_reduce_max(comm, std::vector{own, all_path_sites, candidate_sites, longest});
  const auto sums = all_reduce_sum(comm, std::vector{path_sites, ghosts});
  MeshStatistics result;
  result.own_sites_max = maxima[0];
  result.path_sites_max = maxima[1];
  result.candidate_sites_max = maxima[2];
  result.longest_path = maxima[3];
  result.path_sites = sums[0];
  result.ghosts = sums[1];
  result.slab_sites_min = std::numeric_limits<GlobalIndex>::max();
  for (std::size_t s = 0; s + 1 < mesh.site_offsets.size(); ++s) {
    const GlobalIndex sites = mesh.site_offsets[s + 1] - mesh.site_offsets[s];
    result.slab_sites_min = std::min(result.slab_sites_min, sites);
    result.slab_sites_max = std::max(result.slab_sites_max, sites);
  }
  return result;
}

Error fault_of_mesh(std::string what) {
  return Error({ErrorKind::fault, "the stitched mesh", "", std::move(what),
                "this is a fault of dovetail: please report it with the points"});
}

/// A wrong count is a bug of ours: it must never become a file. All ranks see the same numbers.
void check_euler(const DistributedMesh &mesh) {
  const GlobalIndex triangles = mesh.triangle_count();
  const GlobalIndex expected = 2 * mesh.site_count() - 2 - mesh.hull_edges;
  if (triangles > 0 && triangles != expected)
    throw fault_of_mesh(fmt::format("has {} triangles where {} sites and {} hull edges call for {}",
                                    triangles, mesh.site_count(), mesh.hull_edges, expected));
}

/// Whether all sites of all ranks lie on one line. Collective.
bool sites_are_collinear(const Communicator &comm, const DistributedMesh &mesh) {
  constexpr double unknown = -std::numeric_limits<double>::infinity();
  std::vector<double> ends(4, unknown); // the first and the last site of all
  for (const SlabMesh &slab : mesh.slabs) {
    const auto site = [&](LocalIndex i) { return slab.vertices.points[static_cast<std::size_t>(i)]; };
    if (slab.own_count > 0 && slab.first_site == 0)
      ends = {site(0).x, site(0).y, ends[2], ends[3]};
    if (slab.own_count > 0 && slab.first_site + slab.own_count == mesh.site_count())
      ends = {ends[0], ends[1], site(slab.own_count - 1).x, site(slab.own_count - 1).y};
  }
  ends = all_reduce_max(comm, ends);
  bool turns = false;
  for (const SlabMesh &slab : mesh.slabs)
    turns =
        turns || std::any_of(slab.vertices.points.begin(), slab.vertices.points.begin() + slab.own_count,
                             [&](Point p) {
                               return orientation({ends[0], ends[1]}, {ends[2], ends[3]}, p) != Sign::zero;
                             });
  return !any_of_ranks(comm, turns);
}

/// Of no triangles Euler's relation says nothing; there are none only if the sites lie on one line.
void check_that_none_are_missing(const Communicator &comm, const DistributedMesh &mesh) {
  if (mesh.triangle_count() == 0 && mesh.site_count() > 2 && !sites_are_collinear(comm, mesh))
    throw fault_of_mesh("has no triangles, and its sites do not lie on one line");
}

} // namespace

void stitching::sum_up(const Communicator &comm, GlobalIndex path_sites, GlobalIndex candidate_sites,
                       DistributedMesh &mesh) {
  mesh.statistics = statistics_of(comm, path_sites, candidate_sites, mesh);
  mesh.checksum = all_reduce_sum(comm, mesh.checksum);
  check_euler(mesh);
}

DistributedMesh stitch(const Communicator &comm, UnstitchedMesh &&unstitched) {
  DistributedMesh mesh = std::move(unstitched.mesh);
  const stitching::Owners owners = stitching::owners(comm, mesh);
  stitching::number_triangles(comm, mesh);
  stitching::match_open_sides(comm, owners, unstitched.open_sides, mesh);
  stitching::complete_ghosts(comm, owners, mesh);
  stitching::sum_up(comm, unstitched.path_sites, unstitched.candidate_sites, mesh);
  check_that_none_are_missing(comm, mesh);
  return mesh;
}

} // namespace dovetail
