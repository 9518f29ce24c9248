#include "dovetail/distributed/stream_mesh.hpp"

#include "dovetail/base/error.hpp"
#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/exchange.hpp"
#include "dovetail/distributed/forecast.hpp"
#include "dovetail/distributed/stitch.hpp"
#include "dovetail/distributed/triangulate_region.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace dovetail {
namespace {

std::size_t index(std::int64_t i) { return static_cast<std::size_t>(i); }

/// What every rank learns of a slab before it is triangulated.
struct SlabSizes {
  GlobalIndex triangles, vertices, path, duplicates;
};

std::vector<SlabSizes> sizes_of_own_slabs(const Region &region) {
  const Slabs &slabs = region.slabs;
  std::vector<SlabSizes> sizes;
  std::vector<Point> buffer;
  for (int k = 0; k < slabs.own_slab_count; ++k) {
    const GlobalIndex first = slabs.site_offsets[index(slabs.first_slab + k)];
    const std::span<const Point> own = points_of_slab(slabs, k, buffer);
    const Path &left = region.paths[index(k)];
    const SlabCounts counts = counts_between(own, first, left, region.paths[index(k + 1)], slabs.axis);
    sizes.push_back({counts.triangles, std::ssize(own) + counts.ghosts, std::ssize(left),
                     std::ssize(duplicates_of_slab(slabs, k))});
  }
  return sizes;
}

/// With its memory, which clear() and an assignment of {} keep.
template <class Value> void give_up(std::vector<Value> &values) { std::vector<Value>().swap(values); }

/// What is kept of a slab that has been handed on.
SlabMesh border_of(SlabMesh &&slab) {
  give_up(slab.vertices.points);
  give_up(slab.vertices.input_index);
  for (Attribute &attribute : slab.vertices.attributes)
    give_up(attribute.values);
  give_up(slab.triangles.corners);
  give_up(slab.triangles.neighbours);
  slab.ghost_number.shrink_to_fit();
  return std::move(slab);
}

/// Local. Every own slab through the kernel and into the sink; the open sides of all.
std::vector<stitching::OpenSide> triangulate_into(SlabSink &sink, const Region &region,
                                                  const StreamOptions &options, DistributedMesh &mesh) {
  std::vector<stitching::OpenSide> open_sides;
  const auto begin_phase = [&](const char *name) {
    if (options.phases != nullptr)
      options.phases->begin(name);
  };
  const int count = region.slabs.own_slab_count;
  begin_phase("triangulate"); // also where there is no slab: all ranks have the same phases
  begin_phase("write");
  report_progress(options.progress, "triangulate", 0);
  for (int k = 0; k < count; ++k) {
    const int s = mesh.first_slab + k;
    begin_phase("triangulate");
    LoneSlab slab = triangulate_slab(region, k, options.kernel);
    slab.mesh.first_triangle = mesh.triangle_offsets[index(s)];
    mesh.checksum += slab.checksum;
    for (const LocalIndex side : slab.open_sides)
      open_sides.push_back(stitching::open_side(slab.mesh, index(k), side));
    report_progress(options.progress, "triangulate", static_cast<double>(k + 1) / count);
    begin_phase("write");
    sink.take(s, slab.mesh, duplicates_of_slab(region.slabs, k));
    mesh.slabs.push_back(border_of(std::move(slab.mesh)));
  }
  return open_sides;
}

/// Local.
void require_memory(const Region &region, std::int64_t memory_bytes) {
  const Slabs &slabs = region.slabs;
  GlobalIndex largest = 0, of_paths = 0, longest = 0;
  for (int k = 0; k < slabs.own_slab_count; ++k) {
    const auto s = index(slabs.first_slab + k);
    const GlobalIndex left = std::ssize(region.paths[index(k)]),
                      right = std::ssize(region.paths[index(k + 1)]);
    largest = std::max(largest, slabs.site_offsets[s + 1] - slabs.site_offsets[s] + left + right);
    of_paths += right;
    longest = std::max({longest, left, right});
  }
  const std::int64_t needed = largest * bytes_of_slab_site + of_paths * bytes_of_path_site;
  if (memory_bytes > 0 && needed > memory_bytes)
    throw Error({ErrorKind::resource, "--memory", "",
                 fmt::format("paths have up to {} sites: {} bytes more a rank are needed than there are",
                             longest, needed - memory_bytes),
                 "give more memory, or cut fewer slabs (--slabs)"});
}

} // namespace

MeshOutline outline_of(const Communicator &comm, const Region &region) {
  const Slabs &slabs = region.slabs;
  const auto purpose = [&] { return fmt::format("the table of {} slabs", slabs.slab_count()); };
  const auto own = collectively(comm, purpose, [&] {
    if (region.problem)
      throw Error(*region.problem);
    return sizes_of_own_slabs(region);
  });
  const std::vector<SlabSizes> all = all_gather_bulk<SlabSizes>(comm, own).data;
  return collectively(comm, purpose, [&] {
    MeshOutline outline;
    DistributedMesh &mesh = outline.mesh;
    mesh.axis = slabs.axis;
    mesh.site_offsets = slabs.site_offsets;
    mesh.lines = slabs.lines;
    mesh.digest = slabs.digest;
    mesh.first_slab = slabs.first_slab;
    for (const SlabSizes &sizes : all) {
      mesh.triangle_offsets.push_back(mesh.triangle_offsets.back() + sizes.triangles);
      outline.vertex_offsets.push_back(outline.vertex_offsets.back() + sizes.vertices);
      outline.path_offsets.push_back(outline.path_offsets.back() + sizes.path);
      outline.duplicate_offsets.push_back(outline.duplicate_offsets.back() + sizes.duplicates);
    }
    for (const Attribute &attribute : slabs.sites.attributes)
      outline.attribute_names.push_back(attribute.name);
    outline.own_slabs = slabs.own_slab_count;
    return outline;
  });
}

DistributedMesh stream_mesh(const Communicator &comm, Region &&region, SlabSink &sink,
                            const StreamOptions &options) {
  collectively(comm, [&] {
    if (!region.problem)
      require_memory(region, options.memory_bytes);
  });
  MeshOutline outline = outline_of(comm, region);
  outline.mesh.coordinate_system = options.coordinate_system;
  sink.begin(comm, outline);
  DistributedMesh mesh = std::move(outline.mesh);
  auto open_sides = collectively(
      comm, [&] { return fmt::format("triangulating {} slabs", region.slabs.own_slab_count); },
      [&] { return triangulate_into(sink, region, options, mesh); });

  if (options.phases != nullptr)
    options.phases->begin("stitch");
  collectively(comm, [&] { report_progress(options.progress, "stitch", 0); });
  const stitching::Owners owners = stitching::owners(comm, mesh);
  stitching::match_open_sides(comm, owners, std::move(open_sides), mesh);
  const auto records = [&](std::span<const GlobalIndex> numbers) {
    return records_of_sites(region.slabs, numbers);
  };
  stitching::complete_ghosts(comm, owners, records, mesh);
  GlobalIndex path_sites = 0;
  for (const Path &path : region.paths)
    path_sites += std::ssize(path);
  stitching::sum_up(comm, path_sites, region.candidate_sites, mesh);

  if (options.phases != nullptr)
    options.phases->begin("write");
  collectively(comm, [&] {
    report_progress(options.progress, "write", 0);
    for (std::size_t k = 0; k < mesh.slabs.size(); ++k)
      sink.complete(mesh.first_slab + static_cast<int>(k), mesh.slabs[k]);
  });
  sink.finish(mesh.checksum, mesh.hull_edges);
  if (options.phases != nullptr)
    options.phases->end();
  return mesh;
}

} // namespace dovetail
