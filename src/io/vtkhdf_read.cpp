// Reading a mesh. Every rank opens the file for itself and reads its slabs' rows: no collective call, so
// whatever a broken file does to HDF5, it does on one rank, which tells the others afterwards.
#include "dovetail/io/mesh_to_grow.hpp"

#include "vtkhdf_header.hpp"

#include "dovetail/base/huge_pages.hpp"
#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <span>

namespace dovetail {
namespace {

using hdf5::Column;
using vtkhdf::Extents;
using vtkhdf::Header;
using vtkhdf::Reader;

constexpr std::int64_t buffer_bytes = std::int64_t{8} << 20;

template <class T> std::size_t at(T index) { return static_cast<std::size_t>(index); }

/// Local: `work`, and what HDF5 reports of it, as an Error about `path`.
template <class Work> auto told_of(const std::string &path, Work &&work) {
  const hdf5::Quiet quiet;
  try {
    return work();
  } catch (const hdf5::Failure &failure) {
    throw Error({ErrorKind::input, path, failure.place(), failure.what(), "make the mesh again"});
  }
}

/// Collective: the same on every rank.
template <class Work> auto collectively_on(const Communicator &comm, const std::string &path, Work &&work) {
  return collectively(comm, [&] { return told_of(path, work); });
}

/// All long columns of a file, opened and found to have their full length.
struct Columns {
  Column points, ghost_type, input_index, global_number;
  std::vector<Column> attributes; ///< without z
  Column connectivity, offsets, types, neighbours;
  Column paths, duplicates, duplicate_z;
};

Columns open_columns(const Reader &reader, const Header &header) {
  const Extents &extents = header.extents;
  const GlobalIndex vertices = extents.vertices.back();
  const GlobalIndex triangles = extents.triangles.back();
  Columns columns;
  columns.points = reader.column<double>(vtkhdf::points, vertices, 3);
  columns.ghost_type = reader.column<std::uint8_t>(vtkhdf::ghost_type, vertices);
  columns.input_index = reader.column<std::int64_t>(vtkhdf::input_index, vertices);
  columns.global_number = reader.column<std::int64_t>(vtkhdf::global_number, vertices);
  for (const std::string &name : header.attribute_names)
    if (name != vtkhdf::z_attribute)
      columns.attributes.push_back(reader.column<double>(vtkhdf::dataset_of_attribute(name), vertices));
  columns.connectivity = reader.column<std::int32_t>(vtkhdf::connectivity, 3 * triangles);
  columns.offsets = reader.column<std::int32_t>(vtkhdf::offsets, triangles + extents.slabs());
  columns.types = reader.column<std::uint8_t>(vtkhdf::types, triangles);
  columns.neighbours = reader.column<std::int64_t>(vtkhdf::neighbours, triangles, 3);
  columns.paths = reader.column<std::int64_t>(vtkhdf::paths, extents.paths.back());
  columns.duplicates = reader.column<std::int64_t>(vtkhdf::duplicates, extents.duplicates.back(), 2);
  if (header.has_z())
    columns.duplicate_z = reader.column<double>(vtkhdf::duplicate_z, extents.duplicates.back());
  return columns;
}

/// How many numbers the slabs first .. end - 1 have in all columns.
double numbers_of_slabs(const Header &header, int first, int end) {
  const auto rows = [&](const std::vector<GlobalIndex> &offsets) {
    return static_cast<double>(offsets[at(end)] - offsets[at(first)]);
  };
  const Extents &extents = header.extents;
  const auto plain = static_cast<double>(header.attribute_names.size()) - (header.has_z() ? 1 : 0);
  return (6 + plain) * rows(extents.vertices) + 8 * rows(extents.triangles) + (end - first) +
         rows(extents.paths) + (header.has_z() ? 3 : 2) * rows(extents.duplicates);
}

/// Reads the slabs of one file, one after another.
class SlabReader {
public:
  /// `done` counts numbers.
  SlabReader(const Reader &reader, const Header &header, ProgressCount &done, GlobalIndex growth = 0)
      : reader_(reader), header_(header), growth_(growth), columns_(open_columns(reader, header)),
        done_(done) {}

  SlabMesh read(int s) const {
    const Extents &extents = header_.extents;
    SlabMesh slab;
    slab.own_count = static_cast<LocalIndex>(extents.sites[at(s) + 1] - extents.sites[at(s)]);
    slab.first_site = extents.sites[at(s)];
    slab.first_triangle = extents.triangles[at(s)];
    read_vertices(s, slab);
    read_triangles(s, slab);
    const GlobalIndex first = extents.paths[at(s)];
    slab.left_path = rows<GlobalIndex>(columns_.paths, first, extents.paths[at(s) + 1] - first);
    return slab;
  }

  PointTable read_vertices_of(int s) const {
    const std::vector<GlobalIndex> &vertices = header_.extents.vertices;
    return table(vertices[at(s)], vertices[at(s) + 1] - vertices[at(s)]);
  }

  SlabMesh read_ghosts(int s) const {
    const Extents &extents = header_.extents;
    const GlobalIndex first = extents.vertices[at(s)] + extents.sites[at(s) + 1] - extents.sites[at(s)];
    const GlobalIndex count = extents.vertices[at(s) + 1] - first;
    SlabMesh ghosts;
    ghosts.vertices = table(first, count);
    ghosts.ghost_number = rows<GlobalIndex>(columns_.global_number, first, count);
    return ghosts;
  }

  std::vector<Duplicate> read_duplicates(int first_slab, int end_slab) const {
    const GlobalIndex first = header_.extents.duplicates[at(first_slab)];
    const GlobalIndex count = header_.extents.duplicates[at(end_slab)] - first;
    std::vector<Duplicate> result(at(count));
    read_in_pieces<std::int64_t>(columns_.duplicates, first, count,
                                 [&](auto begin, auto end, const std::int64_t *in) {
                                   for (auto d = begin; d < end; ++d, in += 2)
                                     result[at(d)] = {in[0], in[1]};
                                 });
    for (int s = first_slab; s < end_slab; ++s)
      expect_duplicates_of(s, std::span(result), first);
    if (header_.has_z())
      read_in_pieces<double>(columns_.duplicate_z, first, count, [&](auto begin, auto end, const double *in) {
        for (auto d = begin; d < end; ++d)
          result[at(d)].z = *in++;
      });
    return result;
  }

private:
  /// How many vertices slab s is to have room for beyond those that it has: new ones, and those of its two
  /// paths.
  GlobalIndex room(int s) const {
    if (growth_ == 0)
      return 0;
    const auto &paths = header_.extents.paths;
    const std::size_t beyond = std::min(at(s) + 2, paths.size() - 1);
    return growth_ + paths[beyond] - paths[at(s)];
  }

  /// So many values to be read over, and room for `more`.
  template <class T> static std::vector<T> array_of(GlobalIndex count, GlobalIndex more) {
    std::vector<T> values;
    if (more > 0)
      reserve_huge(values, at(count + more));
    values.resize(at(count));
    return values;
  }

  /// Rows first .. first + count - 1 of a column of single numbers; room for `more`.
  template <class T>
  std::vector<T> rows(const Column &column, GlobalIndex first, GlobalIndex count,
                      GlobalIndex more = 0) const {
    auto values = array_of<T>(count, more);
    const std::int64_t step = hdf5::rows_within<T>(buffer_bytes, 1);
    for (std::int64_t begin = 0; begin < count; begin += step) {
      const std::int64_t part = std::min(step, count - begin);
      hdf5::read_rows(column, hdf5::NumberType<T>::native(), first + begin, part, values.data() + begin);
      done_.add(static_cast<double>(part));
    }
    return values;
  }

  template <class T, class Take>
  void read_in_pieces(const Column &column, GlobalIndex first, GlobalIndex count, Take &&take) const {
    hdf5::read_in_pieces<T>(column, first, count, buffer_bytes, [&](auto begin, auto end, const T *in) {
      take(begin, end, in);
      done_.add(static_cast<double>((end - begin) * column.width));
    });
  }

  /// Reads a column that holds nothing new, and refuses the file where it is not what it must be.
  template <class T, class Expected>
  void expect(const Column &column, GlobalIndex first, GlobalIndex count, Expected &&expected) const {
    read_in_pieces<T>(column, first, count, [&](auto begin, auto end, const T *in) {
      for (auto row = begin; row < end; ++row, ++in)
        if (*in != expected(row))
          reader_.refuse(fmt::format("{}, row {}", column.name, first + row),
                         fmt::format("is {} where {} must be", *in, expected(row)));
    });
  }

  [[noreturn]] void refuse_height(GlobalIndex row, double z) const {
    reader_.refuse(fmt::format("{}, row {}", vtkhdf::points, row),
                   fmt::format("has z = {} in a mesh without an attribute z", z));
  }

  /// Refuses duplicates of sites of other slabs: a mesh in memory keeps no offsets of them, so nobody else
  /// would see that those in the file are wrong. `read` begins with row `first`.
  void expect_duplicates_of(int s, std::span<const Duplicate> read, GlobalIndex first) const {
    const Extents &extents = header_.extents;
    for (GlobalIndex row = extents.duplicates[at(s)]; row < extents.duplicates[at(s) + 1]; ++row)
      if (const GlobalIndex site = read[at(row - first)].site;
          site < extents.sites[at(s)] || site >= extents.sites[at(s) + 1])
        reader_.refuse(fmt::format("{}, row {}", vtkhdf::duplicates, row),
                       fmt::format("is of site {}, which is not one of slab {}", site, s));
  }

  void read_vertices(int s, SlabMesh &slab) const {
    const GlobalIndex first = header_.extents.vertices[at(s)];
    const GlobalIndex count = header_.extents.vertices[at(s) + 1] - first;
    slab.vertices = table(first, count, room(s));
    expect<std::uint8_t>(columns_.ghost_type, first, count, [&](auto v) {
      return v < slab.own_count ? std::uint8_t{0} : vtkhdf::duplicate_point;
    });
    expect<std::int64_t>(columns_.global_number, first, slab.own_count,
                         [&](auto v) { return slab.first_site + v; });
    slab.ghost_number =
        rows<GlobalIndex>(columns_.global_number, first + slab.own_count, count - slab.own_count);
  }

  /// Rows first .. first + count - 1 of all vertices; room for `more`.
  PointTable table(GlobalIndex first, GlobalIndex count, GlobalIndex more = 0) const {
    PointTable table;
    table.points = array_of<Point>(count, more);
    auto column = columns_.attributes.begin();
    double *z = nullptr;
    for (const std::string &name : header_.attribute_names) {
      const bool is_z = name == vtkhdf::z_attribute;
      table.attributes.push_back(
          {name, is_z ? array_of<double>(count, more) : rows<double>(*column++, first, count, more)});
      if (is_z)
        z = table.attributes.back().values.data(); // a vector keeps its place when it is moved
    }
    read_in_pieces<double>(columns_.points, first, count, [&](auto begin, auto end, const double *in) {
      for (auto v = begin; v < end; ++v, in += 3) {
        table.points[at(v)] = {in[0], in[1]};
        if (z != nullptr)
          z[v] = in[2];
        else if (!(in[2] == 0))
          refuse_height(first + v, in[2]);
      }
    });
    table.input_index = rows<GlobalIndex>(columns_.input_index, first, count, more);
    return table;
  }

  void read_triangles(int s, SlabMesh &slab) const {
    const GlobalIndex first = header_.extents.triangles[at(s)];
    const GlobalIndex count = header_.extents.triangles[at(s) + 1] - first;
    const GlobalIndex more = 6 * room(s); // sides: of two triangles a vertex
    slab.triangles.corners = rows<LocalIndex>(columns_.connectivity, 3 * first, 3 * count, more);
    slab.triangles.neighbours = array_of<LocalIndex>(3 * count, more);
    read_in_pieces<std::int64_t>(
        columns_.neighbours, first, count, [&](auto begin, auto end, const std::int64_t *in) {
          for (auto side = 3 * begin; side < 3 * end; ++side) {
            const GlobalIndex number = *in++;
            const bool inside = number >= first && number < first + count;
            slab.triangles.neighbours[at(side)] = inside ? static_cast<LocalIndex>(number - first) : none;
            if (!inside && number != none)
              slab.border_sides.push_back({static_cast<LocalIndex>(side), number});
          }
        });
    expect<std::int32_t>(columns_.offsets, header_.extents.first_offset(s), count + 1,
                         [](auto t) { return static_cast<std::int32_t>(3 * t); });
    expect<std::uint8_t>(columns_.types, first, count, [](auto) { return vtkhdf::triangle_cell; });
  }

  const Reader &reader_;
  const Header &header_;
  GlobalIndex growth_; ///< new vertices that every slab is to have room for
  Columns columns_;
  ProgressCount &done_;
};

/// What all ranks share of a mesh, and where the slabs of this rank begin.
DistributedMesh common_of(const Header &header, int rank, int ranks) {
  DistributedMesh mesh;
  mesh.axis = header.axis;
  mesh.site_offsets = header.extents.sites;
  mesh.triangle_offsets = header.extents.triangles;
  mesh.lines = header.lines;
  mesh.hull_edges = header.hull_edges;
  mesh.checksum = header.checksum;
  mesh.digest = header.digest;
  mesh.coordinate_system = header.coordinate_system;
  mesh.domain = header.domain;
  mesh.first_slab = first_slab_of_rank(header.extents.slabs(), rank, ranks);
  return mesh;
}

/// Local.
DistributedMesh read_slabs(const std::string &path, int rank, int ranks, GlobalIndex growth,
                           const Progress &progress) {
  const Reader reader(path);
  const Header header = reader.read_header();
  DistributedMesh mesh = common_of(header, rank, ranks);
  if (mesh.domain)
    reader.read_sides(header, *mesh.domain);
  const int end = first_slab_of_rank(header.extents.slabs(), rank + 1, ranks);
  ProgressCount done(progress, "read", numbers_of_slabs(header, mesh.first_slab, end));
  const SlabReader slab_reader(reader, header, done, growth);
  for (int s = mesh.first_slab; s < end; ++s)
    mesh.slabs.push_back(slab_reader.read(s));
  mesh.duplicates = slab_reader.read_duplicates(mesh.first_slab, end);
  return mesh;
}

/// A file that stays open, and the slab that was asked for last.
class MeshFile : public SlabSource {
public:
  MeshFile(const std::string &path, int rank, int ranks)
      : path_(path), reader_(path), header_(reader_.read_header()), slab_reader_(reader_, header_, nobody_),
        common_(common_of(header_, rank, ranks)),
        end_slab_(first_slab_of_rank(header_.extents.slabs(), rank + 1, ranks)) {}

  const DistributedMesh &common() const override { return common_; }
  int own_slab_count() const override { return end_slab_ - common_.first_slab; }
  const SlabMesh &slab(int k) override {
    slab_ = {}; // two do not fit
    slab_ = told_of(path_, [&] { return slab_reader_.read(common_.first_slab + k); });
    return slab_;
  }
  const PointTable &vertices(int k) override {
    slab_ = {};
    slab_.vertices = told_of(path_, [&] { return slab_reader_.read_vertices_of(common_.first_slab + k); });
    return slab_.vertices;
  }
  SlabMesh ghosts(int k) override {
    return told_of(path_, [&] { return slab_reader_.read_ghosts(common_.first_slab + k); });
  }
  std::span<const Duplicate> duplicates(int k) override {
    const int s = common_.first_slab + k;
    duplicates_ = told_of(path_, [&] { return slab_reader_.read_duplicates(s, s + 1); });
    return duplicates_;
  }

private:
  std::string path_;
  Reader reader_;
  Header header_;
  ProgressCount nobody_{{}, "read", 1}; ///< whoever asks for slabs knows best how far that is
  SlabReader slab_reader_;
  DistributedMesh common_;
  int end_slab_;
  SlabMesh slab_;
  std::vector<Duplicate> duplicates_;
};

/// Smallest and largest coordinates, as a rank has seen them.
struct Box {
  double low_x = std::numeric_limits<double>::infinity(), low_y = low_x;
  double high_x = -low_x, high_y = -low_x;
};

/// Local: of this rank's share of all vertices.
Box read_box(const Reader &reader, const Header &header, int rank, int ranks) {
  const GlobalIndex rows = header.extents.vertices.back();
  const Column column = reader.column<double>(vtkhdf::points, rows, 3);
  const GlobalIndex share = rows / ranks + 1;
  const GlobalIndex first = std::min(rows, share * rank);
  Box box;
  hdf5::read_in_pieces<double>(column, first, std::min(rows, first + share) - first, buffer_bytes,
                               [&](auto begin, auto end, const double *in) {
                                 for (auto v = begin; v < end; ++v, in += 3) {
                                   box.low_x = std::min(box.low_x, in[0]);
                                   box.low_y = std::min(box.low_y, in[1]);
                                   box.high_x = std::max(box.high_x, in[0]);
                                   box.high_y = std::max(box.high_y, in[1]);
                                 }
                               });
  return box;
}

} // namespace

DistributedMesh read_mesh(const Communicator &comm, const std::string &path, const Progress &progress) {
  return read_mesh_to_grow(comm, path, 0, progress);
}

DistributedMesh read_mesh_to_grow(const Communicator &comm, const std::string &path, GlobalIndex growth,
                                  const Progress &progress) {
  return collectively_on(comm, path,
                         [&] { return read_slabs(path, comm.rank(), comm.size(), growth, progress); });
}

std::unique_ptr<SlabSource> open_mesh(const Communicator &comm, const std::string &path) {
  return collectively_on(comm, path, [&]() -> std::unique_ptr<SlabSource> {
    return std::make_unique<MeshFile>(path, comm.rank(), comm.size());
  });
}

MeshDescription describe_mesh(const Communicator &comm, const std::string &path) {
  Box box;
  auto description = collectively_on(comm, path, [&] {
    const Reader reader(path);
    const Header header = reader.read_header();
    const Columns all_are_there = open_columns(reader, header);
    box = read_box(reader, header, comm.rank(), comm.size());
    const Extents &extents = header.extents;
    MeshDescription result;
    result.format_version = header.format_version;
    result.program_version = header.program_version;
    result.axis = header.axis;
    result.slabs = extents.slabs();
    result.sites = extents.sites.back();
    result.ghosts = extents.vertices.back() - extents.sites.back();
    result.triangles = extents.triangles.back();
    result.hull_edges = header.hull_edges;
    result.duplicates = extents.duplicates.back();
    result.path_sites = extents.paths.back();
    result.checksum = header.checksum;
    result.digest = header.digest;
    result.attributes = header.attribute_names;
    result.coordinate_system = header.coordinate_system;
    result.domain = header.domain;
    result.file_bytes = reader.file_bytes();
    return result;
  });
  const std::vector<double> low = all_reduce_min(comm, std::vector<double>{box.low_x, box.low_y});
  const std::vector<double> high = all_reduce_max(comm, std::vector<double>{box.high_x, box.high_y});
  if (low[0] <= high[0] && low[1] <= high[1]) {
    description.lowest = {low[0], low[1]};
    description.highest = {high[0], high[1]};
  }
  return description;
}

} // namespace dovetail
