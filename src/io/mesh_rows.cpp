#include "mesh_rows.hpp"

#include "disk_space.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/serialization.hpp"

#include <fmt/format.h>

namespace dovetail {

std::vector<std::string> gather_attribute_names(const Communicator &comm, const DistributedMesh &mesh) {
  std::vector<std::string> names;
  if (!mesh.slabs.empty())
    for (const Attribute &attribute : mesh.slabs.front().vertices.attributes)
      names.push_back(attribute.name);
  const int source = all_reduce_min(comm, mesh.slabs.empty() ? comm.size() : comm.rank());
  if (source < comm.size())
    broadcast(comm, names, source);
  return names;
}

const Attribute *find_z(const PointTable &table) {
  for (const Attribute &attribute : table.attributes)
    if (attribute.name == "z")
      return &attribute;
  return nullptr;
}

void check_indices(const DistributedMesh &mesh, const std::string &path) {
  const auto refuse = [&](int slab, const char *what) {
    throw Error({ErrorKind::input, path, fmt::format("slab {} of the mesh", slab), what,
                 "check the mesh with dovetail verify, and make it again"});
  };
  int number = mesh.first_slab;
  for (const SlabMesh &slab : mesh.slabs) {
    const std::size_t vertices = slab.vertices.points.size();
    if (slab.own_count < 0 || at(slab.own_count) + slab.ghost_number.size() != vertices ||
        slab.vertices.input_index.size() != vertices ||
        slab.triangles.neighbours.size() != slab.triangles.corners.size())
      refuse(number, "has columns of different lengths");
    for (const Attribute &attribute : slab.vertices.attributes)
      if (attribute.values.size() != vertices)
        refuse(number, "has columns of different lengths");
    for (const LocalIndex corner : slab.triangles.corners)
      if (corner < 0 || at(corner) >= vertices)
        refuse(number, "has a triangle with a corner that is no vertex");
    ++number;
  }
}

void make_room(const Communicator &comm, const OutputFile &file, std::int64_t bytes) {
  collectively(comm, [&] {
    if (!comm.is_root())
      return;
    check_disk_space(file.path(), file.aside(), bytes);
    reserve_disk_space(file.path(), file.aside(), bytes);
  });
}

ProgressCount count_of_rank(const MeshOutline &outline, const MeshWriting &writing, std::int64_t bytes) {
  const DistributedMesh &mesh = outline.mesh;
  const std::size_t begin = at(mesh.first_slab), end = begin + at(outline.own_slabs);
  const GlobalIndex own = mesh.site_offsets[end] - mesh.site_offsets[begin] + mesh.triangle_offsets[end] -
                          mesh.triangle_offsets[begin];
  const GlobalIndex all = std::max<GlobalIndex>(1, mesh.site_count() + mesh.triangle_count());
  return {writing.progress, "write",
          static_cast<double>(bytes) * static_cast<double>(own) / static_cast<double>(all)};
}

ProgressCount count_of_rank(const DistributedMesh &mesh, const MeshWriting &writing, std::int64_t bytes) {
  GlobalIndex own = 0;
  for (const SlabMesh &slab : mesh.slabs)
    own += slab.own_count + slab.triangles.triangle_count();
  const GlobalIndex all = std::max<GlobalIndex>(1, mesh.site_count() + mesh.triangle_count());
  return {writing.progress, "write",
          static_cast<double>(bytes) * static_cast<double>(own) / static_cast<double>(all)};
}

void write_text_at(const Communicator &comm, OutputFile &file, std::int64_t offset, const std::string &text) {
  if (comm.is_root() && !text.empty())
    file.write_at(offset, std::as_bytes(std::span(text)));
}

} // namespace dovetail
