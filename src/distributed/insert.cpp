#include "dovetail/distributed/insert.hpp"

#include "insertion.hpp"

#include "dovetail/comm/collectives.hpp"
#include "dovetail/distributed/number_points.hpp"
#include "dovetail/distributed/stitch.hpp"
#include "open_sides.hpp"

#include <fmt/format.h>

#include <utility>

namespace dovetail {
namespace insertion {

void refuse_mesh(std::string place, std::string what) {
  throw Error({ErrorKind::input, "", std::move(place), std::move(what),
               "dovetail verify tells what is wrong with it; make it again from its points"});
}

namespace {

/// Local. A slab that got no sites and has the paths that it had: only numbers move.
std::vector<LocalIndex> keep_slab(SlabMesh &slab, GlobalIndex first_site, const Path &left) {
  slab.first_site = first_site;
  for (std::size_t i = 0; i < left.size(); ++i)
    slab.left_path[i] = left[i].number;
  std::vector<LocalIndex> sides = open_sides(slab);
  slab.border_sides.clear();
  return sides;
}

/// What comes with sites does not come with ghosts yet: stitching completes them.
void forget_ghost_columns(SlabMesh &slab) {
  slab.vertices.input_index.resize(at(slab.own_count));
  for (Attribute &attribute : slab.vertices.attributes)
    attribute.values.resize(at(slab.own_count));
}

/// Local. `mesh` becomes the slabs of the larger set, not stitched yet.
UnstitchedMesh grow(DistributedMesh &&mesh, const Placement &placement, const PathUpdate &update,
                    const Progress &progress, int &changed_slabs) {
  UnstitchedMesh result;
  std::uint64_t checksum = mesh.first_slab == 0 && !mesh.slabs.empty() ? mesh.checksum : 0;
  for (std::size_t k = 0; k < mesh.slabs.size(); ++k) {
    SlabMesh &slab = mesh.slabs[k];
    const int s = mesh.first_slab + static_cast<int>(k);
    const SlabPaths &paths = update.slabs[k];
    forget_ghost_columns(slab);
    if (placement.count(k) == 0 && !paths.changed()) {
      result.open_sides.push_back(keep_slab(slab, placement.site_offsets[at(s)], paths.left));
    } else {
      GrownSlab grown =
          grow_slab(slab, {placement, s, k, paths, SlabLines(mesh.axis, mesh.lines, s), mesh.axis});
      result.open_sides.push_back(std::move(grown.open_sides));
      checksum += grown.checksum_change;
      ++changed_slabs;
    }
    result.path_sites += std::ssize(paths.left) + (k + 1 == mesh.slabs.size() ? std::ssize(paths.right) : 0);
    report_progress(progress, "insert", static_cast<double>(k + 1) / static_cast<double>(mesh.slabs.size()));
  }
  result.candidate_sites = update.candidate_sites;
  mesh.checksum = checksum;
  mesh.site_offsets = placement.site_offsets;
  result.mesh = std::move(mesh);
  return result;
}

/// As insert(), but that errors about the mesh have no subject.
GrownMesh insert_into_nameless(const Communicator &comm, DistributedMesh &&mesh, PointTable &&points,
                               const InsertOptions &options) {
  GrownMesh grown;
  InsertStatistics &statistics = grown.statistics;
  // Whoever hears of progress may throw to interrupt, so a phase begins where all can agree on that.
  const auto phase = [&](const char *name, auto &&work) {
    const auto begun = [&] {
      collectively(comm, [&] { report_progress(options.progress, name, 0); });
      return work();
    };
    return options.phases ? options.phases->measure(name, begun) : begun();
  };
  if (mesh.slab_count() == 0)
    refuse_mesh("slabs", "are missing: there is none");
  if (any_of_ranks(comm, mesh.domain.has_value()))
    throw Error({ErrorKind::input, "", "",
                 "is the mesh of a domain, whose segments and holes points cannot be inserted into",
                 "add the points to the domain's own input, and mesh it again"});
  const GlobalIndex old_sites = mesh.site_count(), old_points = mesh.digest.points;
  const Placement placement = phase("place", [&] {
    check_points(comm, points, options.points_name);
    unify_attributes(comm, mesh, points, statistics);
    return place_points(comm, std::move(points), options, mesh);
  });
  const PathUpdate update = phase("paths", [&] { return update_paths(comm, placement, mesh); });
  UnstitchedMesh local = phase("insert", [&] {
    statistics.points = mesh.digest.points - old_points;
    return collectively(
        comm, [&] { return fmt::format("inserting {} sites", placement.sites.points.size()); },
        [&] { return grow(std::move(mesh), placement, update, options.progress, statistics.changed_slabs); });
  });
  grown.mesh = phase("stitch", [&] { return stitch(comm, std::move(local)); });
  statistics.sites = grown.mesh.site_count() - old_sites;
  statistics.duplicates = statistics.points - statistics.sites;
  statistics.changed_slabs = all_reduce_sum(comm, statistics.changed_slabs);
  return grown;
}

} // namespace
} // namespace insertion

GrownMesh insert(const Communicator &comm, DistributedMesh &&mesh, PointTable &&points,
                 const InsertOptions &options) {
  try {
    return insertion::insert_into_nameless(comm, std::move(mesh), std::move(points), options);
  } catch (const Error &error) {
    Problem problem = error.problem();
    if (problem.kind == ErrorKind::fault) // ours, or the mesh's where no new site has come near to it
      problem = {
          ErrorKind::input, "", "", "does not fit together with the new points: it " + problem.what,
          "dovetail verify tells whether the mesh is right; if it is, please report this fault of dovetail"};
    if (problem.subject.empty())
      problem.subject = options.mesh_name;
    throw Error(std::move(problem));
  }
}

} // namespace dovetail
