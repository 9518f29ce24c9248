// A mesh as NumPy arrays, one file each. Rows are in global order, so every rank knows its place, and slabs
// do not show but in the order of the triangles.
#include "mesh_formats.hpp"
#include "mesh_rows.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/io/npy.hpp"

#include <fmt/format.h>

#include <array>
#include <memory>
#include <numeric>

namespace dovetail {
namespace {

enum Array : std::size_t { points, index, neighbours, triangles };

/// Headers of the four arrays.
std::array<std::string, 4> headers_of(const DistributedMesh &mesh, int columns) {
  const std::string sides = fmt::format("({}, 3)", mesh.triangle_count());
  return {npy_header(mesh.site_count(), columns),
          npy_array_header("<i8", fmt::format("({},)", mesh.site_count())), npy_array_header("<i8", sides),
          npy_array_header("<i8", sides)};
}

/// The arrays while they are written.
struct Arrays {
  std::array<std::string, 4> headers;
  std::vector<std::unique_ptr<OutputFile>> parts; ///< all but the main one
  std::unique_ptr<OutputFile> main;
  std::int64_t buffer_bytes;

  OutputFile &file(Array array) { return array == triangles ? *main : *parts[array]; }

  template <class T, class Fill>
  void write(Array array, GlobalIndex first, GlobalIndex count, int width, Fill &&fill) {
    const auto begin = static_cast<std::int64_t>(headers[array].size());
    write_rows<T>(file(array), begin + first * width * static_cast<std::int64_t>(sizeof(T)), count, width,
                  buffer_bytes, fill);
  }
};

/// Local.
void write_slab(Arrays &arrays, const SlabMesh &slab, int columns) {
  const PointTable &table = slab.vertices;
  arrays.write<double>(points, slab.first_site, slab.own_count, columns,
                       [&](auto begin, auto end, double *out) {
                         for (auto v = begin; v < end; ++v) {
                           *out++ = table.points[at(v)].x;
                           *out++ = table.points[at(v)].y;
                           for (const Attribute &attribute : table.attributes)
                             *out++ = attribute.values[at(v)];
                         }
                       });
  arrays.write<std::int64_t>(
      index, slab.first_site, slab.own_count, 1, [&](auto begin, auto end, std::int64_t *out) {
        std::copy(table.input_index.begin() + begin, table.input_index.begin() + end, out);
      });
  const GlobalIndex count = slab.triangles.triangle_count();
  arrays.write<std::int64_t>(triangles, slab.first_triangle, count, 3,
                             [&](auto begin, auto end, std::int64_t *out) {
                               for (auto side = 3 * begin; side < 3 * end; ++side)
                                 *out++ = global_number(slab, slab.triangles.corners[at(side)]);
                             });
  NeighbourNumbers number(slab);
  arrays.write<std::int64_t>(neighbours, slab.first_triangle, count, 3,
                             [&](auto begin, auto end, std::int64_t *out) {
                               for (auto side = 3 * begin; side < 3 * end; ++side)
                                 *out++ = number(side);
                             });
}

} // namespace

std::vector<std::string> npy_array_files(const std::string &path) {
  const std::string base = without_extension(path);
  return {base + ".points.npy", base + ".index.npy", base + ".neighbours.npy", base + ".triangles.npy"};
}

std::vector<std::string> write_npy_arrays(const Communicator &comm, const DistributedMesh &mesh,
                                          const std::string &path, const MeshWriting &writing) {
  const int columns = 2 + static_cast<int>(gather_attribute_names(comm, mesh).size());
  std::vector<std::string> names = npy_array_files(path);
  Arrays arrays{headers_of(mesh, columns), {}, nullptr, writing.buffer_bytes};
  for (const Array array : {points, index, neighbours})
    arrays.parts.push_back(std::make_unique<OutputFile>(comm, names[array]));
  arrays.main = std::make_unique<OutputFile>(comm, names[triangles]);
  const std::array<GlobalIndex, 4> numbers{columns * mesh.site_count(), mesh.site_count(),
                                           3 * mesh.triangle_count(), 3 * mesh.triangle_count()};
  ProgressCount count =
      count_of_rank(mesh, writing, 8 * std::accumulate(numbers.begin(), numbers.end(), GlobalIndex{0}));
  for (const Array array : {points, index, neighbours, triangles}) {
    make_room(comm, arrays.file(array),
              static_cast<std::int64_t>(arrays.headers[array].size()) + 8 * numbers[array]);
    arrays.file(array).count_into(&count);
  }
  collectively(comm, [&] {
    for (const Array array : {points, index, neighbours, triangles})
      write_text_at(comm, arrays.file(array), 0, arrays.headers[array]);
    for (const SlabMesh &slab : mesh.slabs)
      write_slab(arrays, slab, columns);
  });
  commit_together(comm, arrays.parts, *arrays.main);
  return names;
}

} // namespace dovetail
