#include "dovetail/distributed/triangulate_region.hpp"

#include "dovetail/base/error.hpp"
#include "dovetail/geometry/predicates.hpp"
#include "dovetail/mesh/checksum.hpp"
#include "dovetail/mesh/divide_and_conquer.hpp"
#include "open_sides.hpp"
#include "slab_lines.hpp"

#include <algorithm>
#include <fmt/core.h>
#include <iterator>
#include <utility>

namespace dovetail {
namespace {

std::size_t index(LocalIndex i) { return static_cast<std::size_t>(i); }
std::size_t index(GlobalIndex i) { return static_cast<std::size_t>(i); }

/// One own slab, as the region has it.
struct SlabView {
  const Slabs &slabs;
  int slab; ///< among all
  GlobalIndex begin, end;
  const Path &left, &right;
};

SlabView view(const Region &region, int k) {
  const auto s = index(region.slabs.first_slab + k);
  return {region.slabs,
          region.slabs.first_slab + k,
          region.slabs.site_offsets[s],
          region.slabs.site_offsets[s + 1],
          region.paths[index(k)],
          region.paths[index(k + 1)]};
}

/// The sites of both paths that other slabs own, ascending by number.
Path foreign_path_sites(const SlabView &slab) {
  Path foreign;
  for (const Path *path : {&slab.left, &slab.right})
    std::copy_if(path->begin(), path->end(), std::back_inserter(foreign),
                 [&](const PathSite &site) { return site.number < slab.begin || site.number >= slab.end; });
  std::ranges::sort(foreign, {}, &PathSite::number);
  const auto same = [](const PathSite &a, const PathSite &b) { return a.number == b.number; };
  foreign.erase(std::unique(foreign.begin(), foreign.end(), same), foreign.end());
  return foreign;
}

void check_local_range(const SlabView &slab, std::size_t vertices) {
  if (vertices > most_delaunay_sites)
    throw Error({ErrorKind::resource, fmt::format("slab {}", slab.slab), "",
                 fmt::format("{} sites with those of its paths, more than the {} that one slab can have",
                             vertices, most_delaunay_sites),
                 "use more slabs (--slabs)"});
}

/// Own sites, with what came with them, and behind them the points of all foreign path sites.
PointTable vertices_of(const SlabView &slab, const Path &foreign) {
  PointTable table = table_of_slab(slab.slabs, slab.slab - slab.slabs.first_slab, foreign.size());
  std::ranges::transform(foreign, std::back_inserter(table.points), &PathSite::point);
  return table;
}

/// Vertices on a path. Only a triangle with all corners on one path can have its circumcenter beyond that
/// path's line: a corner's cell that holds a point beyond the line, and the corner itself on this side, meets
/// the line. (A corner beyond the line is in the set because it is on a path, and then on this one.)
std::vector<bool> path_vertices(const SlabView &slab, std::size_t vertices) {
  std::vector<bool> on_path(vertices, false);
  const std::size_t own = index(slab.end - slab.begin);
  std::fill(on_path.begin() + static_cast<std::ptrdiff_t>(own), on_path.end(), true);
  for (const Path *path : {&slab.left, &slab.right})
    for (const PathSite &site : *path)
      if (site.number >= slab.begin && site.number < slab.end)
        on_path[index(site.number - slab.begin)] = true;
  return on_path;
}

/// What one pass over the kernel's triangles finds.
struct Selection {
  std::vector<LocalIndex> removed;     ///< triangles that belong to other slabs, ascending
  std::vector<LocalIndex> with_ghosts; ///< triangles that stay and have a corner that is not own
};

Selection select(const SlabView &slab, const std::vector<Point> &points, const Triangulation &triangles) {
  const std::vector<bool> on_path = path_vertices(slab, points.size());
  const SlabLines lines(slab.slabs.axis, slab.slabs.lines, slab.slab);
  const auto own = static_cast<LocalIndex>(slab.end - slab.begin);
  Selection selection;
  for (LocalIndex t = 0; t < triangles.triangle_count(); ++t) {
    const LocalIndex *corner = &triangles.corners[3 * index(t)];
    const std::size_t a = index(corner[0]), b = index(corner[1]), c = index(corner[2]);
    if (on_path[a] && on_path[b] && on_path[c] && !lines.hold_circumcenter(points[a], points[b], points[c]))
      selection.removed.push_back(t);
    else if (corner[0] >= own || corner[1] >= own || corner[2] >= own)
      selection.with_ghosts.push_back(t);
  }
  return selection;
}

/// Drops the ghosts that no remaining triangle uses; the others keep their order.
void keep_used_ghosts(const Selection &selection, const Path &foreign, SlabMesh &mesh) {
  std::vector<LocalIndex> renumbered(foreign.size(), none);
  auto &corners = mesh.triangles.corners;
  const auto for_ghost_corners = [&](auto &&work) {
    for (const LocalIndex t : selection.with_ghosts)
      for (std::size_t i = 0; i < 3; ++i)
        if (LocalIndex &corner = corners[3 * index(t) + i]; corner >= mesh.own_count)
          work(corner, renumbered[index(corner - mesh.own_count)]);
  };
  for_ghost_corners([](LocalIndex, LocalIndex &used) { used = 0; });
  auto &points = mesh.vertices.points;
  points.resize(index(mesh.own_count));
  for (std::size_t g = 0; g < foreign.size(); ++g)
    if (renumbered[g] != none) {
      renumbered[g] = static_cast<LocalIndex>(points.size());
      points.push_back(foreign[g].point);
      mesh.ghost_number.push_back(foreign[g].number);
    }
  for_ghost_corners([](LocalIndex &corner, LocalIndex number) { corner = number; });
}

/// The paths and the kernel know nothing of each other, so that a fault of either shows here.
void check_counts(const SlabView &slab, const SlabMesh &mesh) {
  const auto own = std::span(mesh.vertices.points).first(index(mesh.own_count));
  const SlabCounts expected = counts_between(own, slab.begin, slab.left, slab.right, slab.slabs.axis);
  const SlabCounts found{mesh.triangles.triangle_count(), std::ssize(mesh.ghost_number)};
  if (found != expected)
    throw Error({ErrorKind::fault, fmt::format("slab {}", slab.slab), "",
                 fmt::format("has {} triangles and {} ghosts where its sites and paths call for {} and {}",
                             found.triangles, found.ghosts, expected.triangles, expected.ghosts),
                 "this is a fault of dovetail: please report it with the points"});
}

Triangulation triangles_of(std::span<const Point> sites, const KernelChoice &choice) {
  return choice.kernel == Kernel::split_path ? delaunay_by_split_paths(sites, choice.trace) : delaunay(sites);
}

SlabMesh mesh_of(const SlabView &slab, const KernelChoice &kernel) {
  const Path foreign = foreign_path_sites(slab);
  check_local_range(slab, index(slab.end - slab.begin) + foreign.size());
  SlabMesh mesh;
  mesh.own_count = static_cast<LocalIndex>(slab.end - slab.begin);
  mesh.first_site = slab.begin;
  mesh.vertices = vertices_of(slab, foreign);
  std::ranges::transform(slab.left, std::back_inserter(mesh.left_path), &PathSite::number);

  mesh.triangles = triangles_of(mesh.vertices.points, kernel);
  const Selection selection = select(slab, mesh.vertices.points, mesh.triangles);
  keep_used_ghosts(selection, foreign, mesh);
  remove_triangles(mesh.triangles, selection.removed);
  check_counts(slab, mesh);
  return mesh;
}

std::uint64_t checksum_of(const SlabMesh &mesh) {
  return checksum_of_sites(std::span(mesh.vertices.points).first(index(mesh.own_count))) +
         checksum_of_triangles(mesh.vertices.points, mesh.triangles.corners);
}

} // namespace

void remove_triangles(Triangulation &triangles, std::span<const LocalIndex> removed) {
  auto &corners = triangles.corners;
  auto &neighbours = triangles.neighbours;
  // Whoever has `from` for a neighbour of triangle t gets `to`.
  const auto redirect = [&](LocalIndex t, LocalIndex to) {
    for (std::size_t i = 0; i < 3; ++i)
      if (const LocalIndex beyond = neighbours[3 * index(t) + i]; beyond != none)
        std::replace(&neighbours[3 * index(beyond)], &neighbours[3 * index(beyond)] + 3, t, to);
  };
  for (const LocalIndex t : removed)
    redirect(t, none);
  LocalIndex count = triangles.triangle_count();
  auto last_removed = removed.rbegin();
  for (const LocalIndex hole : removed) {
    // Holes before this one are filled already.
    while (last_removed != removed.rend() && *last_removed >= hole && *last_removed == count - 1) {
      ++last_removed;
      --count;
    }
    if (hole >= count)
      break;
    const LocalIndex last = --count;
    redirect(last, hole);
    std::copy_n(&corners[3 * index(last)], 3, &corners[3 * index(hole)]);
    std::copy_n(&neighbours[3 * index(last)], 3, &neighbours[3 * index(hole)]);
  }
  corners.resize(3 * index(count));
  neighbours.resize(3 * index(count));
}

LoneSlab triangulate_slab(const Region &region, int k, const KernelChoice &kernel) {
  LoneSlab slab;
  slab.mesh = mesh_of(view(region, k), kernel);
  slab.open_sides = open_sides(slab.mesh.triangles);
  slab.checksum = checksum_of(slab.mesh);
  return slab;
}

UnstitchedMesh triangulate_region(Region &&region, const Progress &progress, const KernelChoice &kernel) {
  if (region.problem)
    throw Error(*region.problem);
  UnstitchedMesh result;
  DistributedMesh &mesh = result.mesh;
  const int count = region.slabs.own_slab_count;
  report_progress(progress, "triangulate", 0);
  for (int k = 0; k < count; ++k) {
    LoneSlab slab = triangulate_slab(region, k, kernel);
    mesh.slabs.push_back(std::move(slab.mesh));
    mesh.checksum += slab.checksum;
    result.open_sides.push_back(std::move(slab.open_sides));
    report_progress(progress, "triangulate", static_cast<double>(k + 1) / count);
  }
  for (const Path &path : region.paths)
    result.path_sites += static_cast<GlobalIndex>(path.size());
  result.candidate_sites = region.candidate_sites;
  mesh.axis = region.slabs.axis;
  mesh.site_offsets = std::move(region.slabs.site_offsets);
  mesh.lines = std::move(region.slabs.lines);
  mesh.digest = region.slabs.digest;
  mesh.first_slab = region.slabs.first_slab;
  mesh.duplicates = std::move(region.slabs.duplicates);
  return result;
}

} // namespace dovetail
