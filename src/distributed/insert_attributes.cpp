#include "insertion.hpp"

#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/serialization.hpp"

#include <limits>

namespace dovetail::insertion {
namespace {

using Names = std::vector<std::string>;

Names names_of(const PointTable &table) {
  Names names;
  for (const Attribute &attribute : table.attributes)
    names.push_back(attribute.name);
  return names;
}

Names those_absent(const Names &wanted, const Names &there) {
  Names absent;
  std::ranges::copy_if(wanted, std::back_inserter(absent), [&](const std::string &name) {
    return std::ranges::find(there, name) == there.end();
  });
  return absent;
}

/// The mesh's attributes, then those of the points that it has not; z first.
Names union_of(const Names &of_mesh, const Names &absent_in_mesh) {
  Names all = of_mesh;
  all.insert(all.end(), absent_in_mesh.begin(), absent_in_mesh.end());
  std::ranges::stable_partition(all, [](const std::string &name) { return name == "z"; });
  return all;
}

/// The same columns by other names, and in another order.
void conform(PointTable &table, const Names &names) {
  std::vector<Attribute> columns;
  for (const std::string &name : names) {
    const auto found = std::ranges::find(table.attributes, name, &Attribute::name);
    if (found != table.attributes.end())
      columns.push_back(std::move(*found));
    else
      columns.push_back(
          {name, std::vector<double>(table.points.size(),
                                     name == "z" ? 0.0 : std::numeric_limits<double>::quiet_NaN())});
  }
  table.attributes = std::move(columns);
}

} // namespace

void unify_attributes(const Communicator &comm, DistributedMesh &mesh, PointTable &points,
                      InsertStatistics &statistics) {
  // Where there are fewer slabs than ranks, it is the last rank that has one.
  Names of_mesh = mesh.slabs.empty() ? Names() : names_of(mesh.slabs.front().vertices);
  broadcast(comm, of_mesh, comm.size() - 1);
  const Names of_points = names_of(points); // check_points: the same on all ranks
  statistics.absent_in_points = those_absent(of_mesh, of_points);
  statistics.absent_in_mesh = those_absent(of_points, of_mesh);
  const Names all = union_of(of_mesh, statistics.absent_in_mesh);
  collectively(comm, [&] {
    if (of_points != all)
      conform(points, all);
    if (of_mesh != all)
      for (SlabMesh &slab : mesh.slabs)
        conform(slab.vertices, all);
  });
}

} // namespace dovetail::insertion
