#include "dovetail/distributed/domain_slab.hpp"

#include "dovetail/mesh/checksum.hpp"

#include <algorithm>
#include <numeric>

namespace dovetail {
namespace {

constexpr const char *marker_attribute = "marker";

template <class Index> std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Of every vertex: its place in the total order.
std::vector<LocalIndex> ranks_of(const std::vector<Point> &points, const std::vector<LocalIndex> &order) {
  std::vector<LocalIndex> rank(points.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    rank[at(order[i])] = static_cast<LocalIndex>(i);
  return rank;
}

template <class Value>
std::vector<Value> in_order(const std::vector<Value> &values, const std::vector<LocalIndex> &order) {
  std::vector<Value> result;
  result.reserve(order.size());
  for (const LocalIndex i : order)
    result.push_back(values[at(i)]);
  return result;
}

void renumber(DomainRecord &record, const std::vector<LocalIndex> &rank) {
  for (Segment &segment : record.segments) {
    segment.from = rank[at(segment.from)];
    segment.to = rank[at(segment.to)];
  }
  for (LocalIndex &vertex : record.chain_vertices)
    vertex = rank[at(vertex)];
}

} // namespace

DistributedMesh slab_of_domain(DomainMesh mesh, DomainRecord record, DomainVertices vertices) {
  std::vector<LocalIndex> order(mesh.vertices.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, lexicographically_less, [&](LocalIndex v) { return mesh.vertices[at(v)]; });
  const std::vector<LocalIndex> rank = ranks_of(mesh.vertices, order);

  DistributedMesh result;
  SlabMesh &slab = result.slabs.emplace_back();
  slab.own_count = static_cast<LocalIndex>(order.size());
  slab.vertices.points = in_order(mesh.vertices, order);
  slab.vertices.input_index = in_order(vertices.input_index, order);
  for (const Attribute &attribute : vertices.attributes)
    slab.vertices.attributes.push_back({attribute.name, in_order(attribute.values, order)});
  std::vector<double> markers(mesh.vertex_markers.begin(), mesh.vertex_markers.end());
  slab.vertices.attributes.push_back({marker_attribute, in_order(markers, order)});
  slab.triangles = std::move(mesh.triangles);
  for (LocalIndex &corner : slab.triangles.corners)
    corner = rank[at(corner)];

  renumber(record, rank);
  record.segment_of_side = std::move(mesh.segment_of_side);
  record.region = std::move(mesh.region);
  result.domain = std::move(record);

  result.site_offsets.push_back(slab.own_count);
  result.triangle_offsets.push_back(slab.triangles.triangle_count());
  result.hull_edges = std::ranges::count(slab.triangles.neighbours, none);
  result.checksum = checksum_of_sites(slab.vertices.points) +
                    checksum_of_triangles(slab.vertices.points, slab.triangles.corners);
  result.duplicates = std::move(vertices.duplicates);
  for (Duplicate &duplicate : result.duplicates)
    duplicate.site = rank[at(duplicate.site)];
  std::ranges::sort(result.duplicates, [](const Duplicate &a, const Duplicate &b) {
    return std::pair(a.site, a.input_index) < std::pair(b.site, b.input_index);
  });
  // The digest is that of sites and duplicates, Steiner points included.
  result.digest.points = slab.own_count + std::ssize(result.duplicates);
  for (std::size_t v = 0; v < order.size(); ++v)
    result.digest.hash += digest_of_point(slab.vertices.points[v], 0, slab.vertices.input_index[v]);
  for (const Duplicate &duplicate : result.duplicates)
    result.digest.hash += digest_of_point(slab.vertices.points[at(duplicate.site)], 0, duplicate.input_index);
  return result;
}

DomainMesh domain_of_slab(const DistributedMesh &mesh) {
  const SlabMesh &slab = mesh.slabs.front();
  DomainMesh result;
  result.vertices = slab.vertices.points;
  result.vertex_markers.assign(result.vertices.size(), 0);
  for (const Attribute &attribute : slab.vertices.attributes)
    if (attribute.name == marker_attribute)
      std::ranges::transform(attribute.values, result.vertex_markers.begin(),
                             [](double value) { return static_cast<std::int32_t>(value); });
  result.triangles = slab.triangles;
  result.segment_of_side = record_of(mesh).segment_of_side;
  result.region = record_of(mesh).region;
  return result;
}

} // namespace dovetail
