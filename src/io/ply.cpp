// PLY, "Polygon File Format" (Greg Turk, 1994), binary little endian: the sites in global order, then the
// triangles as lists of three 32-bit numbers. All records of a kind are equally long, so places are known.
#include "mesh_formats.hpp"
#include "mesh_rows.hpp"

#include "dovetail/comm/agreement.hpp"

#include <fmt/format.h>

#include <cctype>
#include <limits>

namespace dovetail {
namespace {

constexpr int face_bytes = 1 + 3 * 4;

/// PLY takes the sites of a mesh by int: more than that cannot be said.
void check_counts(const DistributedMesh &mesh, const std::string &path) {
  constexpr GlobalIndex most = std::numeric_limits<std::int32_t>::max();
  const GlobalIndex largest = std::max(mesh.site_count(), mesh.triangle_count());
  if (largest > most)
    throw Error({ErrorKind::resource, path, "",
                 fmt::format("has 32-bit indices and cannot hold {} sites and {} triangles",
                             mesh.site_count(), mesh.triangle_count()),
                 "choose a name that ends in .vtkhdf, .pvtu or .npy"});
}

/// A property's name is one word.
std::string property_name(std::string name) {
  for (char &c : name)
    if (std::isgraph(static_cast<unsigned char>(c)) == 0)
      c = '_';
  return name.empty() ? "_" : name;
}

std::string header_of(const DistributedMesh &mesh, const std::vector<std::string> &names) {
  std::string text = fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n"
                                 "property double x\nproperty double y\nproperty double z\n",
                                 mesh.site_count());
  for (const std::string &name : names)
    if (name != "z")
      text += fmt::format("property double {}\n", property_name(name));
  return text + fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                            mesh.triangle_count());
}

/// Where things are.
struct Layout {
  std::string header;
  int columns;        ///< numbers of a vertex
  std::int64_t faces; ///< where they begin
  std::int64_t buffer_bytes;
};

void write_slab(OutputFile &file, const SlabMesh &slab, const Layout &layout) {
  const PointTable &table = slab.vertices;
  const Attribute *z = find_z(table);
  const auto first_vertex =
      static_cast<std::int64_t>(layout.header.size()) + slab.first_site * layout.columns * 8;
  write_rows<double>(file, first_vertex, slab.own_count, layout.columns, layout.buffer_bytes,
                     [&](auto begin, auto end, double *out) {
                       for (auto v = begin; v < end; ++v) {
                         *out++ = table.points[at(v)].x;
                         *out++ = table.points[at(v)].y;
                         *out++ = z != nullptr ? z->values[at(v)] : 0.0;
                         for (const Attribute &attribute : table.attributes)
                           if (&attribute != z)
                             *out++ = attribute.values[at(v)];
                       }
                     });
  write_rows<std::byte>(file, layout.faces + slab.first_triangle * face_bytes,
                        slab.triangles.triangle_count(), face_bytes, layout.buffer_bytes,
                        [&](auto begin, auto end, std::byte *out) {
                          for (auto side = 3 * begin; side < 3 * end; ++side) {
                            if (side % 3 == 0)
                              *out++ = std::byte{3};
                            const GlobalIndex number = global_number(slab, slab.triangles.corners[at(side)]);
                            store_little(static_cast<std::int32_t>(number), out);
                            out += sizeof(std::int32_t);
                          }
                        });
}

} // namespace

std::vector<std::string> write_ply(const Communicator &comm, const DistributedMesh &mesh,
                                   const std::string &path, const MeshWriting &writing) {
  check_counts(mesh, path); // the same on all ranks
  const std::vector<std::string> names = gather_attribute_names(comm, mesh);
  Layout layout{header_of(mesh, names), 3, 0, writing.buffer_bytes};
  for (const std::string &name : names)
    layout.columns += name != "z" ? 1 : 0;
  layout.faces = static_cast<std::int64_t>(layout.header.size()) + mesh.site_count() * layout.columns * 8;
  const std::int64_t file_bytes = layout.faces + mesh.triangle_count() * face_bytes;
  ProgressCount count = count_of_rank(mesh, writing, file_bytes);
  OutputFile file(comm, path);
  file.count_into(&count);
  make_room(comm, file, file_bytes);
  collectively(comm, [&] {
    write_text_at(comm, file, 0, layout.header);
    for (const SlabMesh &slab : mesh.slabs)
      write_slab(file, slab, layout);
  });
  file.commit();
  return {path};
}

} // namespace dovetail
