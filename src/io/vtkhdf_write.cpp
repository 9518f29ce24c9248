// Writing a mesh: the first rank alone makes the file with everything in it but the long columns, and
// reserves its space on disk. The columns are contiguous and their places known, so then all ranks fill in
// their slabs' rows, each for itself, without HDF5.
//
// Why not parallel HDF5: it opens the file through MPI, and where one rank then meets a full disk, the others
// may wait for it for ever (measured with Open MPI 4.1.4, in MPI_File_open already). This way, what fails
// fails on a rank that can say so. And the bytes cannot depend on the number of ranks.
#include "disk_space.hpp"
#include "hdf5.hpp"
#include "mesh_formats.hpp"
#include "mesh_rows.hpp"
#include "vtkhdf.hpp"
#include "vtkhdf_skeleton.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/exchange.hpp"
#include "dovetail/comm/serialization.hpp"
#include "dovetail/io/output_file.hpp"

#include <boost/serialization/map.hpp>

#include <algorithm>
#include <cassert>
#include <map>
#include <span>

namespace dovetail {
namespace {

struct SlabSizes {
  GlobalIndex vertices;
  GlobalIndex path;
  GlobalIndex duplicates;
};

/// Collective.
vtkhdf::Extents gather_extents(const Communicator &comm, const DistributedMesh &mesh) {
  std::vector<SlabSizes> own;
  auto duplicate = mesh.duplicates.begin();
  for (const SlabMesh &slab : mesh.slabs) {
    const GlobalIndex end = slab.first_site + slab.own_count;
    const auto next = std::find_if(duplicate, mesh.duplicates.end(),
                                   [end](const Duplicate &entry) { return entry.site >= end; });
    own.push_back({static_cast<GlobalIndex>(slab.vertices.points.size()),
                   static_cast<GlobalIndex>(slab.left_path.size()), next - duplicate});
    duplicate = next;
  }
  if (duplicate != mesh.duplicates.end() && !own.empty()) // a map out of order is still written whole
    own.back().duplicates += mesh.duplicates.end() - duplicate;

  const Exchanged<SlabSizes> all = all_gather_bulk<SlabSizes>(comm, own);
  assert(all.data.size() == at(mesh.slab_count()));
  vtkhdf::Extents extents;
  extents.sites = mesh.site_offsets;
  extents.triangles = mesh.triangle_offsets;
  for (const SlabSizes &sizes : all.data) {
    extents.vertices.push_back(extents.vertices.back() + sizes.vertices);
    extents.paths.push_back(extents.paths.back() + sizes.path);
    extents.duplicates.push_back(extents.duplicates.back() + sizes.duplicates);
  }
  return extents;
}

/// Fills in the long columns of a file. Local.
class Columns {
public:
  Columns(OutputFile &file, const std::map<std::string, std::int64_t> &places, std::int64_t buffer_bytes)
      : file_(file), places_(places), buffer_bytes_(buffer_bytes) {}

  /// Writes `count` rows of `width` numbers from row `first` on, made piece by piece: fill(begin, end, out)
  /// puts rows begin .. end - 1, counted from `first`, to `out`.
  template <class T, class Fill>
  void write(const std::string &name, GlobalIndex first, GlobalIndex count, int width, Fill &&fill) const {
    const auto row_bytes = static_cast<std::int64_t>(sizeof(T)) * width;
    write_rows<T>(file_, places_.at(name) + first * row_bytes, count, width, buffer_bytes_, fill);
  }

  template <class T>
  void write(const std::string &name, GlobalIndex first, const std::vector<T> &values) const {
    write<T>(name, first, static_cast<GlobalIndex>(values.size()), 1,
             [&](std::int64_t begin, std::int64_t end, T *out) {
               std::copy(values.begin() + begin, values.begin() + end, out);
             });
  }

private:
  OutputFile &file_;
  const std::map<std::string, std::int64_t> &places_;
  std::int64_t buffer_bytes_;
};

void write_vertices(const Columns &columns, const SlabMesh &slab, GlobalIndex first) {
  const PointTable &table = slab.vertices;
  const auto count = static_cast<GlobalIndex>(table.points.size());
  columns.write<double>(vtkhdf::points, first, count, 3, PointRows(table));
  columns.write<std::uint8_t>(vtkhdf::ghost_type, first, count, 1,
                              [&](auto begin, auto end, std::uint8_t *out) {
                                for (auto v = begin; v < end; ++v)
                                  *out++ = v < slab.own_count ? std::uint8_t{0} : vtkhdf::duplicate_point;
                              });
  columns.write(vtkhdf::input_index, first, table.input_index);
  columns.write<std::int64_t>(vtkhdf::global_number, first, count, 1,
                              [&](auto begin, auto end, std::int64_t *out) {
                                for (auto v = begin; v < end; ++v)
                                  *out++ = global_number(slab, static_cast<LocalIndex>(v));
                              });
  for (const Attribute &attribute : table.attributes)
    if (attribute.name != vtkhdf::z_attribute)
      columns.write(vtkhdf::dataset_of_attribute(attribute.name), first, attribute.values);
}

void write_triangles(const Columns &columns, const SlabMesh &slab, GlobalIndex first,
                     GlobalIndex first_offset) {
  const Triangulation &local = slab.triangles;
  const auto count = static_cast<GlobalIndex>(local.triangle_count());
  columns.write(vtkhdf::connectivity, 3 * first, local.corners);
  columns.write<std::int32_t>(vtkhdf::offsets, first_offset, count + 1, 1,
                              [](auto begin, auto end, std::int32_t *out) {
                                for (auto t = begin; t < end; ++t)
                                  *out++ = static_cast<std::int32_t>(3 * t);
                              });
  columns.write<std::uint8_t>(vtkhdf::types, first, count, 1, [](auto begin, auto end, std::uint8_t *out) {
    std::fill_n(out, end - begin, vtkhdf::triangle_cell);
  });
  NeighbourNumbers number(slab);
  columns.write<std::int64_t>(vtkhdf::neighbours, first, count, 3,
                              [&](auto begin, auto end, std::int64_t *out) {
                                for (auto side = 3 * begin; side < 3 * end; ++side)
                                  *out++ = number(side);
                              });
}

void write_duplicates(const Columns &columns, const std::vector<Duplicate> &duplicates, GlobalIndex first,
                      bool has_z) {
  const auto count = static_cast<GlobalIndex>(duplicates.size());
  columns.write<std::int64_t>(vtkhdf::duplicates, first, count, 2,
                              [&](auto begin, auto end, std::int64_t *out) {
                                for (auto d = begin; d < end; ++d) {
                                  *out++ = duplicates[at(d)].input_index;
                                  *out++ = duplicates[at(d)].site;
                                }
                              });
  if (has_z)
    columns.write<double>(vtkhdf::duplicate_z, first, count, 1, [&](auto begin, auto end, double *out) {
      for (auto d = begin; d < end; ++d)
        *out++ = duplicates[at(d)].z;
    });
}

/// Local: this rank's rows of every long column.
void write_rows_of_rank(const Columns &columns, const DistributedMesh &mesh, const vtkhdf::Extents &extents,
                        bool has_z) {
  int s = mesh.first_slab;
  for (const SlabMesh &slab : mesh.slabs) {
    write_vertices(columns, slab, extents.vertices[at(s)]);
    write_triangles(columns, slab, extents.triangles[at(s)], extents.first_offset(s));
    columns.write(vtkhdf::paths, extents.paths[at(s)], slab.left_path);
    ++s;
  }
  if (!mesh.slabs.empty())
    write_duplicates(columns, mesh.duplicates, extents.duplicates[at(mesh.first_slab)], has_z);
}

/// Local, on one rank. Throws Error about the file's final name.
vtkhdf::Skeleton prepare(const OutputFile &file, const DistributedMesh &mesh, const vtkhdf::Extents &extents,
                         const std::vector<std::string> &names) {
  vtkhdf::check_attribute_names(names, file.path());
  check_disk_space(file.path(), file.aside(), vtkhdf::estimated_bytes(mesh, extents, names));
  const hdf5::Quiet quiet;
  vtkhdf::Skeleton skeleton;
  try {
    skeleton = vtkhdf::make_skeleton(file.aside(), mesh, extents, names);
  } catch (const hdf5::Failure &failure) {
    throw Error({ErrorKind::output, file.path(), failure.place(), failure.what(),
                 "make room, or name a file on another disk"});
  }
  reserve_disk_space(file.path(), file.aside(), skeleton.file_bytes);
  return skeleton;
}

} // namespace

std::vector<std::string> write_vtkhdf(const Communicator &comm, const DistributedMesh &mesh,
                                      const std::string &path, const MeshWriting &writing) {
  const vtkhdf::Extents extents = gather_extents(comm, mesh);
  const std::vector<std::string> names = gather_attribute_names(comm, mesh);
  const bool has_z = std::find(names.begin(), names.end(), vtkhdf::z_attribute) != names.end();
  OutputFile file(comm, path);
  vtkhdf::Skeleton skeleton = collectively(
      comm, [&] { return comm.is_root() ? prepare(file, mesh, extents, names) : vtkhdf::Skeleton{}; });
  broadcast(comm, skeleton.column_bytes);
  broadcast(comm, skeleton.file_bytes);
  ProgressCount count = count_of_rank(mesh, writing, skeleton.file_bytes);
  file.count_into(&count);
  collectively(comm, [&] {
    write_rows_of_rank(Columns(file, skeleton.column_bytes, writing.buffer_bytes), mesh, extents, has_z);
  });
  file.commit();
  return {path};
}

} // namespace dovetail
