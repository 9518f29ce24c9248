#include "vtkhdf_skeleton.hpp"

#include "hdf5.hpp"

#include "dovetail/base/error.hpp"
#include "dovetail/io/mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <string_view>

namespace dovetail::vtkhdf {
namespace {

using hdf5::Handle;
using hdf5::NumberType;

constexpr int format_of_points = 1; // of meshes without a domain, which older programs read

/// Makes objects one after another, always in the same order and without times, so that equal meshes make
/// equal bytes.
class Maker {
public:
  explicit Maker(hid_t file)
      : file_(file), creation_(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "cannot make a property list") {
    hdf5::check(H5Pset_obj_track_times(creation_.id(), false), "cannot do without times");
    hdf5::check(H5Pset_layout(creation_.id(), H5D_CONTIGUOUS), "cannot set the layout");
    hdf5::check(H5Pset_alloc_time(creation_.id(), H5D_ALLOC_TIME_EARLY), "cannot set the allocation");
    hdf5::check(H5Pset_fill_time(creation_.id(), H5D_FILL_TIME_NEVER), "cannot do without filling");
  }

  void group(const char *name) const {
    const Handle properties(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, "cannot make a property list");
    hdf5::check(H5Pset_obj_track_times(properties.id(), false), "cannot do without times");
    // Links and attributes in the object itself, where a few reads find them all.
    hdf5::check(H5Pset_link_phase_change(properties.id(), 64, 32), "cannot keep links together");
    hdf5::check(H5Pset_attr_phase_change(properties.id(), 64, 32), "cannot keep attributes together");
    const Handle made(H5Gcreate2(file_, name, H5P_DEFAULT, properties.id(), H5P_DEFAULT), H5Gclose,
                      "cannot be made", name);
  }

  Handle dataset(const std::string &name, hid_t type, GlobalIndex rows, int width = 1) const {
    const std::array<hsize_t, 2> size{static_cast<hsize_t>(rows), static_cast<hsize_t>(width)};
    const Handle space(H5Screate_simple(width == 1 ? 1 : 2, size.data(), nullptr), H5Sclose,
                       "cannot make a data space");
    return {H5Dcreate2(file_, name.c_str(), type, space.id(), H5P_DEFAULT, creation_.id(), H5P_DEFAULT),
            H5Dclose, "cannot be made", name};
  }

  /// A long column, to be filled in later.
  template <class T> void column(const std::string &name, GlobalIndex rows, int width = 1) {
    const Handle made = dataset(name, NumberType<T>::stored(), rows, width);
    const haddr_t offset = H5Dget_offset(made.id());
    if (rows > 0 && offset == HADDR_UNDEF)
      hdf5::fail("has no place in the file", name);
    column_bytes_[name] = rows > 0 ? static_cast<std::int64_t>(offset) : 0;
  }
  const std::map<std::string, std::int64_t> &column_bytes() const { return column_bytes_; }

  /// A column with its contents, row by row.
  template <class T>
  void contents(const std::string &name, const std::vector<T> &values, int width = 1) const {
    const Handle made =
        dataset(name, NumberType<T>::stored(), static_cast<GlobalIndex>(values.size()) / width, width);
    write(made, NumberType<T>::native(), values.data(), values.empty(), name);
  }

  void contents(const std::string &name, const std::vector<std::string> &texts) const {
    std::size_t length = 1;
    for (const std::string &text : texts)
      length = std::max(length, text.size());
    std::string padded;
    for (const std::string &text : texts)
      padded += text + std::string(length - text.size(), '\0');
    const Handle type = text_type(length);
    const Handle made = dataset(name, type.id(), static_cast<GlobalIndex>(texts.size()));
    write(made, type.id(), padded.data(), texts.empty(), name);
  }

  template <class T> void number(const char *object, const char *name, std::vector<T> values) const {
    const hsize_t count = values.size();
    const Handle space(count == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &count, nullptr), H5Sclose,
                       "cannot make a data space");
    attribute(object, name, NumberType<T>::stored(), NumberType<T>::native(), space, values.data());
  }

  /// VTK takes only ASCII of fixed length here.
  void text(const std::string &object, const char *name, std::string value) const {
    if (value.empty())
      value.push_back('\0'); // HDF5 has no strings of length 0
    const Handle type = text_type(value.size());
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose, "cannot make a data space");
    attribute(object.c_str(), name, type.id(), type.id(), space, value.data());
  }

private:
  static Handle text_type(std::size_t length) {
    Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "cannot make a text type");
    hdf5::check(H5Tset_size(type.id(), length), "cannot make a text type");
    hdf5::check(H5Tset_strpad(type.id(), H5T_STR_NULLPAD), "cannot make a text type");
    return type;
  }

  static void write(const Handle &made, hid_t type, const void *data, bool empty, const std::string &name) {
    if (!empty)
      hdf5::check(H5Dwrite(made.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), "cannot be written", name);
  }

  void attribute(const char *object, const char *name, hid_t stored, hid_t native, const Handle &space,
                 const void *data) const {
    const std::string place = fmt::format("{}, attribute {}", object, name);
    const Handle made(
        H5Acreate_by_name(file_, object, name, stored, space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
        H5Aclose, "cannot be made", place);
    hdf5::check(H5Awrite(made.id(), native, data), "cannot be written", place);
  }

  hid_t file_;
  Handle creation_;
  std::map<std::string, std::int64_t> column_bytes_;
};

std::vector<std::int64_t> differences(const std::vector<GlobalIndex> &offsets, GlobalIndex factor = 1) {
  std::vector<std::int64_t> counts;
  for (std::size_t s = 1; s < offsets.size(); ++s)
    counts.push_back(factor * (offsets[s] - offsets[s - 1]));
  return counts;
}

bool contains_z(const std::vector<std::string> &names) {
  return std::find(names.begin(), names.end(), z_attribute) != names.end();
}

void make_vtk_part(Maker &make, const Extents &extents, const std::vector<std::string> &names) {
  const GlobalIndex vertices = extents.vertices.back();
  const GlobalIndex triangle_rows = extents.triangles.back();
  make.group(vtk_group);
  make.number<std::int64_t>(vtk_group, "Version", {1, 0});
  make.text(vtk_group, "Type", "UnstructuredGrid");
  make.contents(number_of_points, differences(extents.vertices));
  make.contents(number_of_cells, differences(extents.triangles));
  make.contents(number_of_connectivity_ids, differences(extents.triangles, 3));
  make.column<double>(points, vertices, 3);
  make.column<std::int32_t>(connectivity, 3 * triangle_rows);
  make.column<std::int32_t>(offsets, triangle_rows + extents.slabs());
  make.column<std::uint8_t>(types, triangle_rows);
  make.group(point_data_group);
  make.column<std::uint8_t>(ghost_type, vertices);
  make.column<std::int64_t>(input_index, vertices);
  make.column<std::int64_t>(global_number, vertices);
  for (const std::string &name : names)
    if (name != z_attribute)
      make.column<double>(dataset_of_attribute(name), vertices);
}

void make_own_part(Maker &make, const DistributedMesh &mesh, const Extents &extents,
                   const std::vector<std::string> &names) {
  make.group(own_group);
  make.number<std::int64_t>(own_group, "format_version",
                            {mesh.domain ? mesh_format_version : format_of_points});
  make.text(own_group, "program_version", DOVETAIL_VERSION);
  make.text(own_group, "axis", mesh.axis == Axis::x ? "x" : "y");
  make.number<std::uint64_t>(own_group, "checksum", {mesh.checksum});
  make.number<std::int64_t>(own_group, "hull_edges", {mesh.hull_edges});
  make.number<std::int64_t>(own_group, "digest_points", {mesh.digest.points});
  make.number<std::uint64_t>(own_group, "digest_hash", {mesh.digest.hash});
  make.contents(site_offsets, extents.sites);
  make.contents(triangle_offsets, extents.triangles);
  make.contents(path_offsets, extents.paths);
  make.contents(duplicate_offsets, extents.duplicates);
  make.contents(own_counts, differences(extents.sites));
  make.contents(lines, mesh.lines);
  make.contents(attribute_names, names);
  make.column<std::int64_t>(neighbours, extents.triangles.back(), 3);
  make.column<std::int64_t>(paths, extents.paths.back());
  make.column<std::int64_t>(duplicates, extents.duplicates.back(), 2);
  if (contains_z(names))
    make.column<double>(duplicate_z, extents.duplicates.back());
}

void make_records(const Maker &make, const std::vector<CoordinateSystemRecord> &records) {
  make.group(records_group);
  for (std::size_t i = 0; i < records.size(); ++i) {
    const std::string name = fmt::format("{}/{}", records_group, i);
    make.contents(name, records[i].bytes);
    make.text(name, "user_id", records[i].user_id);
    make.number<std::uint16_t>(name.c_str(), "record_id", {records[i].record_id});
    make.text(name, "description", records[i].description);
  }
}

std::vector<std::int64_t> widened(const std::vector<LocalIndex> &values) {
  return {values.begin(), values.end()};
}

/// All of it at once: the mesh of a domain is made by one process.
void make_domain(const Maker &make, const DomainRecord &domain) {
  std::vector<std::int64_t> ends;
  std::vector<std::int32_t> markers;
  for (const Segment &segment : domain.segments) {
    ends.insert(ends.end(), {segment.from, segment.to});
    markers.push_back(segment.marker);
  }
  std::vector<double> hole_places, region_rows;
  for (const Point hole : domain.holes)
    hole_places.insert(hole_places.end(), {hole.x, hole.y});
  for (const RegionSeed &region : domain.regions)
    region_rows.insert(region_rows.end(),
                       {region.place.x, region.place.y, region.attribute, region.max_area});
  make.group(cell_data_group);
  make.contents(region_of_cell, domain.region);
  make.group(domain_group);
  make.number<std::int64_t>(domain_group, "even_odd", {domain.even_odd ? 1 : 0});
  make.number<std::int64_t>(domain_group, "hull_segments", {domain.hull_segments});
  make.number<std::int64_t>(domain_group, "given_vertices", {domain.given_vertices});
  make.number<double>(domain_group, "min_angle", {domain.min_angle});
  make.contents(segments, ends, 2);
  make.contents(segment_markers, markers);
  make.contents(is_line, domain.is_line);
  make.contents(holes, hole_places, 2);
  make.contents(regions, region_rows, 4);
  make.contents(segment_of_side, domain.segment_of_side, 3);
  make.contents(chain_offsets, widened(domain.chain_offsets));
  make.contents(chain_vertices, widened(domain.chain_vertices));
  make.contents(left_triangles, widened(domain.left_triangles));
}

} // namespace

void check_attribute_names(const std::vector<std::string> &names, const std::string &path) {
  std::set<std::string_view> taken(reserved_names.begin(), reserved_names.end());
  for (const std::string &name : names) {
    const bool possible = !name.empty() && name != "." && name.find('/') == std::string::npos &&
                          name.find('\0') == std::string::npos;
    if (!possible || !taken.insert(name).second)
      throw Error({ErrorKind::usage, path, fmt::format("attribute \"{}\"", name),
                   possible ? "the name is taken" : "is not a name for a dataset", "rename the attribute"});
  }
}

namespace {

std::int64_t estimated_bytes_of(const DomainRecord &domain) {
  const auto bytes = [](const auto &values, std::size_t each) {
    return static_cast<std::int64_t>(values.size() * each);
  };
  return bytes(domain.region, 4) + bytes(domain.segment_of_side, 4) + bytes(domain.segments, 21) +
         bytes(domain.holes, 16) + bytes(domain.regions, 32) + bytes(domain.chain_offsets, 8) +
         bytes(domain.chain_vertices, 8) + bytes(domain.left_triangles, 8) + 16384;
}

} // namespace

std::int64_t estimated_bytes(const DistributedMesh &mesh, const Extents &extents,
                             const std::vector<std::string> &names) {
  const auto attributes = static_cast<std::int64_t>(names.size());
  std::int64_t bytes = extents.vertices.back() * (24 + 1 + 8 + 8 + 8 * attributes);
  bytes += extents.triangles.back() * (12 + 4 + 1 + 24);
  bytes += extents.paths.back() * 8 + extents.duplicates.back() * 24;
  bytes += (extents.slabs() + 1) * std::int64_t{4 + 8 * 9};
  for (const CoordinateSystemRecord &record : mesh.coordinate_system)
    bytes += static_cast<std::int64_t>(record.bytes.size() + record.description.size()) + 4096;
  if (mesh.domain)
    bytes += estimated_bytes_of(*mesh.domain);
  constexpr std::int64_t metadata = 65536; // about 12 KiB and 300 bytes an attribute, measured
  return bytes + metadata + 1024 * attributes;
}

void set_results(const std::string &path, std::uint64_t checksum, GlobalIndex hull_edges) {
  const Handle access = hdf5::unlocked_access();
  hdf5::check(H5Pset_libver_bounds(access.id(), H5F_LIBVER_V18, H5F_LIBVER_V18), "cannot set the version");
  Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, access.id()), H5Fclose, "cannot be opened again");
  const auto set = [&](const char *name, hid_t type, const void *value) {
    // Not H5Aopen_by_name: HDF5 1.10 does not find again what it has opened so, when it is to be written.
    const Handle group(H5Gopen2(file.id(), own_group, H5P_DEFAULT), H5Gclose, "cannot be opened", own_group);
    const Handle attribute(H5Aopen(group.id(), name, H5P_DEFAULT), H5Aclose, "cannot be opened", name);
    hdf5::check(H5Awrite(attribute.id(), type, value), "cannot be written", name);
  };
  set("checksum", NumberType<std::uint64_t>::native(), &checksum);
  set("hull_edges", NumberType<std::int64_t>::native(), &hull_edges);
  hdf5::check(H5Fflush(file.id(), H5F_SCOPE_GLOBAL), "cannot be written");
  file.close("cannot be closed");
}

Skeleton make_skeleton(const std::string &path, const DistributedMesh &mesh, const Extents &extents,
                       const std::vector<std::string> &names) {
  const Handle access = hdf5::unlocked_access();
  // The format of HDF5 1.8 has checksums over all metadata. Damage in that of 1.6 crashes the library itself.
  hdf5::check(H5Pset_libver_bounds(access.id(), H5F_LIBVER_V18, H5F_LIBVER_V18), "cannot set the version");
  const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "cannot make a property list");
  hdf5::check(H5Pset_obj_track_times(creation.id(), false), "cannot do without times"); // of the root group
  Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation.id(), access.id()), H5Fclose, "cannot be made");
  Skeleton skeleton;
  {
    Maker make(file.id());
    make_vtk_part(make, extents, names);
    make_own_part(make, mesh, extents, names);
    make_records(make, mesh.coordinate_system);
    if (mesh.domain)
      make_domain(make, *mesh.domain);
    skeleton.column_bytes = make.column_bytes();
  }
  hdf5::check(H5Fflush(file.id(), H5F_SCOPE_GLOBAL), "cannot be written");
  file.close("cannot be closed");
  skeleton.file_bytes = static_cast<std::int64_t>(std::filesystem::file_size(path));
  return skeleton;
}

} // namespace dovetail::vtkhdf
