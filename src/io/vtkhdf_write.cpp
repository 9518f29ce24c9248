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
#include "dovetail/distributed/slab_sink.hpp"
#include "dovetail/io/output_file.hpp"

#include <boost/serialization/map.hpp>

#include <algorithm>
#include <cassert>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>

namespace dovetail {
namespace {

struct SlabSizes {
  GlobalIndex vertices;
  GlobalIndex path;
  GlobalIndex duplicates;
};

/// The duplicates of every slab's sites. A map out of order is still written whole.
std::vector<std::span<const Duplicate>> duplicates_by_slab(const DistributedMesh &mesh) {
  std::vector<std::span<const Duplicate>> pieces;
  auto begin = mesh.duplicates.begin();
  for (const SlabMesh &slab : mesh.slabs) {
    const GlobalIndex end = slab.first_site + slab.own_count;
    const auto next = pieces.size() + 1 == mesh.slabs.size()
                          ? mesh.duplicates.end()
                          : std::find_if(begin, mesh.duplicates.end(),
                                         [end](const Duplicate &entry) { return entry.site >= end; });
    pieces.emplace_back(begin, next);
    begin = next;
  }
  return pieces;
}

/// Collective.
MeshOutline outline_of(const Communicator &comm, const DistributedMesh &mesh) {
  std::vector<SlabSizes> own;
  const std::vector<std::span<const Duplicate>> duplicates = duplicates_by_slab(mesh);
  for (std::size_t k = 0; k < mesh.slabs.size(); ++k)
    own.push_back({std::ssize(mesh.slabs[k].vertices.points), std::ssize(mesh.slabs[k].left_path),
                   std::ssize(duplicates[k])});
  const Exchanged<SlabSizes> all = all_gather_bulk<SlabSizes>(comm, own);
  assert(all.data.size() == at(mesh.slab_count()));
  MeshOutline outline;
  outline.mesh.axis = mesh.axis;
  outline.mesh.site_offsets = mesh.site_offsets;
  outline.mesh.triangle_offsets = mesh.triangle_offsets;
  outline.mesh.lines = mesh.lines;
  outline.mesh.digest = mesh.digest;
  outline.mesh.coordinate_system = mesh.coordinate_system;
  outline.mesh.domain = mesh.domain;
  outline.mesh.first_slab = mesh.first_slab;
  outline.own_slabs = static_cast<int>(mesh.slabs.size());
  outline.attribute_names = gather_attribute_names(comm, mesh);
  for (const SlabSizes &sizes : all.data) {
    outline.vertex_offsets.push_back(outline.vertex_offsets.back() + sizes.vertices);
    outline.path_offsets.push_back(outline.path_offsets.back() + sizes.path);
    outline.duplicate_offsets.push_back(outline.duplicate_offsets.back() + sizes.duplicates);
  }
  return outline;
}

vtkhdf::Extents extents_of(const MeshOutline &outline) {
  return {outline.vertex_offsets, outline.mesh.site_offsets, outline.mesh.triangle_offsets,
          outline.path_offsets, outline.duplicate_offsets};
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

  /// Sets numbers of a column among others that were written and stay: number place(i), counted from `first`
  /// and ascending, to value(i). Where they lie closely a stretch is read, changed and written again: as many
  /// small writes take longer than everything else.
  template <class T, class Place, class Value>
  void set(const std::string &name, GlobalIndex first, std::size_t count, Place &&place,
           Value &&value) const {
    constexpr GlobalIndex longest = GlobalIndex{1} << 17, widest_gap = GlobalIndex{1} << 12;
    std::vector<T> stretch;
    for (std::size_t i = 0, end = 0; i < count; i = end) {
      const GlobalIndex begin = place(i);
      for (end = i + 1;
           end < count && place(end) - place(end - 1) <= widest_gap && place(end) - begin < longest;)
        ++end;
      stretch.resize(at(place(end - 1) - begin) + 1);
      const std::int64_t offset = places_.at(name) + (first + begin) * static_cast<std::int64_t>(sizeof(T));
      if (stretch.size() > end - i) // something lies between them
        file_.read_at(offset, std::as_writable_bytes(std::span(stretch)));
      for (; i < end; ++i)
        stretch[at(place(i) - begin)] = value(i);
      file_.write_at(offset, std::as_bytes(std::span(stretch)));
    }
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

void write_duplicates(const Columns &columns, std::span<const Duplicate> duplicates, GlobalIndex first,
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

/// Runs work of HDF5 on the file aside. Throws Error about its final name.
template <class Work> auto with_hdf5(const OutputFile &file, Work &&work) {
  const hdf5::Quiet quiet;
  try {
    return work();
  } catch (const hdf5::Failure &failure) {
    throw Error({ErrorKind::output, file.path(), failure.place(), failure.what(),
                 "make room, or name a file on another disk"});
  }
}

/// Local, on one rank. Throws Error about the file's final name.
vtkhdf::Skeleton prepare(const OutputFile &file, const DistributedMesh &mesh, const vtkhdf::Extents &extents,
                         const std::vector<std::string> &names) {
  vtkhdf::check_attribute_names(names, file.path());
  check_disk_space(file.path(), file.aside(), vtkhdf::estimated_bytes(mesh, extents, names));
  vtkhdf::Skeleton skeleton = with_hdf5(file, [&] {
    const auto lock = file.keep_from_being_abandoned();
    return vtkhdf::make_skeleton(file.aside(), mesh, extents, names);
  });
  reserve_disk_space(file.path(), file.aside(), skeleton.file_bytes);
  return skeleton;
}

/// Writes one file, slab by slab.
class MeshFile : public SlabSink {
public:
  MeshFile(std::string path, MeshWriting writing) : path_(std::move(path)), writing_(std::move(writing)) {}

  void begin(const Communicator &comm, const MeshOutline &outline) override;
  void take(int slab, const SlabMesh &mesh, std::span<const Duplicate> duplicates) override;
  void complete(int slab, const SlabMesh &border) override;
  void finish(std::uint64_t checksum, GlobalIndex hull_edges) override;

private:
  Columns columns() { return Columns(*file_, places_, writing_.buffer_bytes); }

  std::string path_;
  MeshWriting writing_;
  const Communicator *comm_ = nullptr;
  std::unique_ptr<OutputFile> file_; ///< from begin() on
  std::optional<ProgressCount> count_;
  std::map<std::string, std::int64_t> places_; ///< of the columns, in bytes
  vtkhdf::Extents extents_;
  bool has_z_ = false;
};

void MeshFile::begin(const Communicator &comm, const MeshOutline &outline) {
  comm_ = &comm;
  extents_ = extents_of(outline);
  const std::vector<std::string> &names = outline.attribute_names;
  has_z_ = std::find(names.begin(), names.end(), vtkhdf::z_attribute) != names.end();
  file_ = std::make_unique<OutputFile>(comm, path_);
  vtkhdf::Skeleton skeleton = collectively(comm, [&] {
    return comm.is_root() ? prepare(*file_, outline.mesh, extents_, names) : vtkhdf::Skeleton{};
  });
  broadcast(comm, skeleton.column_bytes);
  broadcast(comm, skeleton.file_bytes);
  places_ = std::move(skeleton.column_bytes);
  count_.emplace(count_of_rank(outline, writing_, skeleton.file_bytes));
  file_->count_into(&*count_);
}

void MeshFile::take(int slab, const SlabMesh &mesh, std::span<const Duplicate> duplicates) {
  write_vertices(columns(), mesh, extents_.vertices[at(slab)]);
  write_triangles(columns(), mesh, extents_.triangles[at(slab)], extents_.first_offset(slab));
  columns().write(vtkhdf::paths, extents_.paths[at(slab)], mesh.left_path);
  write_duplicates(columns(), duplicates, extents_.duplicates[at(slab)], has_z_);
}

void MeshFile::complete(int slab, const SlabMesh &border) {
  const GlobalIndex first_ghost = extents_.vertices[at(slab)] + border.own_count;
  columns().write(vtkhdf::input_index, first_ghost, border.vertices.input_index);
  for (const Attribute &attribute : border.vertices.attributes)
    if (attribute.name == vtkhdf::z_attribute)
      columns().set<double>(
          vtkhdf::points, 3 * first_ghost + 2, attribute.values.size(),
          [](std::size_t i) { return 3 * static_cast<GlobalIndex>(i); },
          [&](std::size_t i) { return attribute.values[i]; });
    else
      columns().write(vtkhdf::dataset_of_attribute(attribute.name), first_ghost, attribute.values);
  const std::vector<BorderSide> &sides = border.border_sides;
  columns().set<GlobalIndex>(
      vtkhdf::neighbours, 3 * extents_.triangles[at(slab)], sides.size(),
      [&](std::size_t i) { return GlobalIndex{sides[i].side}; },
      [&](std::size_t i) { return sides[i].neighbour; });
}

void MeshFile::finish(std::uint64_t checksum, GlobalIndex hull_edges) {
  collectively(*comm_, [&] {
    if (comm_->is_root())
      with_hdf5(*file_, [&] { vtkhdf::set_results(file_->aside(), checksum, hull_edges); });
  });
  file_->commit();
}

} // namespace

std::unique_ptr<SlabSink> stream_vtkhdf(const std::string &path, const MeshWriting &writing) {
  return std::make_unique<MeshFile>(path, writing);
}

std::vector<std::string> write_vtkhdf(const Communicator &comm, const DistributedMesh &mesh,
                                      const std::string &path, const MeshWriting &writing) {
  MeshFile file(path, writing);
  file.begin(comm, outline_of(comm, mesh));
  collectively(comm, [&] {
    const std::vector<std::span<const Duplicate>> duplicates = duplicates_by_slab(mesh);
    for (std::size_t k = 0; k < mesh.slabs.size(); ++k)
      file.take(mesh.first_slab + static_cast<int>(k), mesh.slabs[k], duplicates[k]);
  });
  file.finish(mesh.checksum, mesh.hull_edges);
  return {path};
}

} // namespace dovetail
