// A mesh for VTK's XML readers: one .vtu of the whole mesh in global numbers, or a .pvtu with one .vtu for
// each slab in its own numbers, ghosts included.
#include "mesh_formats.hpp"
#include "mesh_rows.hpp"
#include "vtu.hpp"

#include "dovetail/comm/agreement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <filesystem>
#include <memory>

namespace dovetail {
namespace {

using vtu::Array;
using vtu::Layout;

constexpr std::uint8_t triangle_cell = 5;   // VTK_TRIANGLE
constexpr std::uint8_t duplicate_point = 1; // vtkDataSetAttributes::DUPLICATEPOINT

std::vector<std::string> without_z(std::vector<std::string> names) {
  std::erase(names, "z");
  return names;
}

/// Local: all of a file that does not belong to a slab.
void write_frame(const Communicator &comm, OutputFile &file, const Layout &layout) {
  write_text_at(comm, file, 0, layout.head);
  write_text_at(comm, file, layout.file_bytes - static_cast<std::int64_t>(layout.tail.size()), layout.tail);
  if (!comm.is_root())
    return;
  for (const std::vector<Array> *group : {&layout.points, &layout.cells, &layout.point_data})
    for (const Array &array : *group)
      write_rows<std::uint64_t>(file, array.place - 8, 1, 1, 8, [&](auto, auto, std::uint64_t *out) {
        *out = static_cast<std::uint64_t>(array.bytes());
      });
}

/// Where a slab's rows go in a file.
struct Place {
  GlobalIndex point;    ///< row of its first vertex
  GlobalIndex triangle; ///< row of its first triangle
  GlobalIndex points;   ///< how many of its vertices, from the first on
};

/// One slab into one file. Local.
class SlabWriter {
public:
  SlabWriter(OutputFile &file, const Layout &layout, const SlabMesh &slab, Place place,
             std::int64_t buffer_bytes)
      : file_(file), layout_(layout), slab_(slab), place_(place), buffer_bytes_(buffer_bytes) {}

  /// In numbers of type Index, those of vertex(v) for the slab's vertex v.
  template <class Index, class Vertex> void write_cells(Vertex &&vertex) const {
    const GlobalIndex count = slab_.triangles.triangle_count();
    write<Index>(layout_.cells[0], 3 * place_.triangle, 3 * count, [&](auto begin, auto end, Index *out) {
      for (auto side = begin; side < end; ++side)
        *out++ = static_cast<Index>(vertex(slab_.triangles.corners[at(side)]));
    });
    write<Index>(layout_.cells[1], place_.triangle, count, [&](auto begin, auto end, Index *out) {
      for (auto t = begin; t < end; ++t)
        *out++ = static_cast<Index>(3 * (place_.triangle + t + 1));
    });
    write<std::uint8_t>(
        layout_.cells[2], place_.triangle, count,
        [](auto begin, auto end, std::uint8_t *out) { std::fill_n(out, end - begin, triangle_cell); });
  }

  void write_points() const {
    const PointTable &table = slab_.vertices;
    write<double>(layout_.points[0], place_.point, place_.points, PointRows(table));
    auto array = layout_.point_data.begin();
    write_column(*array++, table.input_index);
    if (array != layout_.point_data.end() && array->name == "global_number") {
      write<std::int64_t>(*array++, place_.point, place_.points,
                          [&](auto begin, auto end, std::int64_t *out) {
                            for (auto v = begin; v < end; ++v)
                              *out++ = global_number(slab_, static_cast<LocalIndex>(v));
                          });
      write<std::uint8_t>(*array++, place_.point, place_.points,
                          [&](auto begin, auto end, std::uint8_t *out) {
                            for (auto v = begin; v < end; ++v)
                              *out++ = v < slab_.own_count ? std::uint8_t{0} : duplicate_point;
                          });
    }
    for (const Attribute &attribute : table.attributes)
      if (attribute.name != "z")
        write_column(*array++, attribute.values);
    assert(array == layout_.point_data.end());
  }

private:
  template <class T, class Fill>
  void write(const Array &array, GlobalIndex first, GlobalIndex rows, Fill &&fill) const {
    assert(sizeof(T) == at(array.number_bytes));
    const auto row_bytes = static_cast<std::int64_t>(sizeof(T)) * array.components;
    write_rows<T>(file_, array.place + first * row_bytes, rows, array.components, buffer_bytes_, fill);
  }
  template <class T> void write_column(const Array &array, const std::vector<T> &values) const {
    write<T>(array, place_.point, place_.points, [&](auto begin, auto end, T *out) {
      std::copy(values.begin() + begin, values.begin() + end, out);
    });
  }

  OutputFile &file_;
  const Layout &layout_;
  const SlabMesh &slab_;
  const Place place_;
  const std::int64_t buffer_bytes_;
};

Layout layout_of_part(const SlabMesh &slab, const std::vector<std::string> &attributes) {
  const auto vertices = static_cast<GlobalIndex>(slab.vertices.points.size());
  return vtu::layout_of({vertices, slab.triangles.triangle_count(), sizeof(LocalIndex), true, attributes});
}

/// The part of a slab, of its own name, whole and on disk but for its name. Local: `alone` is this rank's
/// own.
std::unique_ptr<OutputFile> write_part(const Communicator &alone, const std::string &path,
                                       const SlabMesh &slab, const std::vector<std::string> &attributes,
                                       std::int64_t buffer_bytes, ProgressCount &count) {
  const auto vertices = static_cast<GlobalIndex>(slab.vertices.points.size());
  const Layout layout = layout_of_part(slab, attributes);
  auto file = std::make_unique<OutputFile>(alone, path);
  file->count_into(&count);
  make_room(alone, *file, layout.file_bytes);
  write_frame(alone, *file, layout);
  const SlabWriter writer(*file, layout, slab, {0, 0, vertices}, buffer_bytes);
  writer.write_points();
  writer.write_cells<LocalIndex>([](LocalIndex v) { return v; });
  file->sync(); // and closes it: a rank may have more slabs than descriptors
  return file;
}

} // namespace

std::vector<std::string> write_vtu(const Communicator &comm, const DistributedMesh &mesh,
                                   const std::string &path, const MeshWriting &writing) {
  const Layout layout = vtu::layout_of({mesh.site_count(), mesh.triangle_count(), sizeof(GlobalIndex), false,
                                        without_z(gather_attribute_names(comm, mesh))});
  ProgressCount count = count_of_rank(mesh, writing, layout.file_bytes);
  OutputFile file(comm, path);
  file.count_into(&count);
  make_room(comm, file, layout.file_bytes);
  collectively(comm, [&] {
    write_frame(comm, file, layout);
    for (const SlabMesh &slab : mesh.slabs) {
      const SlabWriter writer(file, layout, slab, {slab.first_site, slab.first_triangle, slab.own_count},
                              writing.buffer_bytes);
      writer.write_points();
      writer.write_cells<GlobalIndex>([&](LocalIndex v) { return global_number(slab, v); });
    }
  });
  file.commit();
  return {path};
}

std::vector<std::string> write_pvtu(const Communicator &comm, const DistributedMesh &mesh,
                                    const std::string &path, const MeshWriting &writing) {
  const std::vector<std::string> attributes = without_z(gather_attribute_names(comm, mesh));
  std::vector<std::string> files, sources; // as they are made, and as the summary names them
  for (int s = 0; s < mesh.slab_count(); ++s) {
    files.push_back(fmt::format("{}.{}.vtu", without_extension(path), s));
    sources.push_back(std::filesystem::path(files.back()).filename().string());
  }
  std::int64_t bytes = 0;
  for (const SlabMesh &slab : mesh.slabs)
    bytes += layout_of_part(slab, attributes).file_bytes;
  ProgressCount count(writing.progress, "write", static_cast<double>(bytes));
  const Communicator alone = comm.split(comm.rank());
  std::vector<std::unique_ptr<OutputFile>> parts;
  OutputFile file(comm, path);
  collectively(comm, [&] {
    for (const SlabMesh &slab : mesh.slabs)
      parts.push_back(write_part(alone, files[at(mesh.first_slab) + parts.size()], slab, attributes,
                                 writing.buffer_bytes, count));
    write_text_at(comm, file, 0,
                  vtu::summary_of(vtu::layout_of({0, 0, sizeof(LocalIndex), true, attributes}), sources));
  });
  commit_together(comm, parts, file);
  files.push_back(path);
  return files;
}

} // namespace dovetail
