#include "vtkhdf_header.hpp"

#include "dovetail/io/input_file.hpp"
#include "dovetail/io/mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace dovetail::vtkhdf {
namespace {

using hdf5::Column;
using hdf5::Handle;
using hdf5::NumberType;

template <class T> std::size_t at(T index) { return static_cast<std::size_t>(index); }

std::string extent_text(const std::vector<hsize_t> &extent) {
  std::string text;
  for (const hsize_t size : extent)
    text += fmt::format("{}{}", text.empty() ? "(" : ", ", size);
  return text.empty() ? "()" : text + ")";
}

std::vector<hsize_t> extent_of(const Handle &dataset, const std::string &name) {
  const Handle space(H5Dget_space(dataset.id()), H5Sclose, "cannot tell its extent", name);
  const int dimensions = H5Sget_simple_extent_ndims(space.id());
  hdf5::check(dimensions, "cannot tell its extent", name);
  std::vector<hsize_t> extent(at(dimensions));
  hdf5::check(H5Sget_simple_extent_dims(space.id(), extent.data(), nullptr), "cannot tell its extent", name);
  return extent;
}

} // namespace

bool Header::has_z() const {
  return std::find(attribute_names.begin(), attribute_names.end(), z_attribute) != attribute_names.end();
}

Reader::Reader(const std::string &path) : path_(path), file_bytes_(InputFile(path).bytes()) {
  const htri_t is_hdf5 = H5Fis_hdf5(path.c_str());
  if (is_hdf5 <= 0)
    refuse({}, "is not an HDF5 file", "name a mesh made by dovetail triangulate");
  const Handle access = hdf5::unlocked_access();
  file_ = Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose,
                 "is damaged, truncated or not completely written");
}

void Reader::refuse(const std::string &place, const std::string &what, const std::string &remedy) const {
  throw Error({ErrorKind::input, path_, place, what, remedy});
}

bool Reader::exists(const std::string &name) const {
  // Every step of the way must exist before H5Lexists may be asked about the last.
  for (std::size_t slash = name.find('/'); slash != std::string::npos; slash = name.find('/', slash + 1))
    if (H5Lexists(file_.id(), name.substr(0, slash).c_str(), H5P_DEFAULT) <= 0)
      return false;
  return H5Lexists(file_.id(), name.c_str(), H5P_DEFAULT) > 0;
}

Column Reader::open_column_of_any_length(const std::string &name, hid_t type, int width) const {
  if (!exists(name))
    refuse(name, "is missing");
  Column column{Handle(H5Dopen2(file_.id(), name.c_str(), H5P_DEFAULT), H5Dclose, "is not a dataset", name),
                name, 0, width};
  const Handle stored(H5Dget_type(column.dataset.id()), H5Tclose, "cannot tell its type", name);
  if (type >= 0 && H5Tequal(stored.id(), type) <= 0)
    refuse(name, "has another type of number than a mesh file has");
  const std::vector<hsize_t> extent = extent_of(column.dataset, name);
  const std::size_t dimensions = width == 1 ? 1 : 2;
  if (extent.size() != dimensions || (dimensions == 2 && extent[1] != static_cast<hsize_t>(width)))
    refuse(name, fmt::format("has shape {} where {} columns must be", extent_text(extent), width));

  // Contiguous storage as long as the extent claims, and not more than the file: only then is a size
  // believed.
  const Handle properties(H5Dget_create_plist(column.dataset.id()), H5Pclose, "cannot tell its layout", name);
  if (H5Pget_layout(properties.id()) != H5D_CONTIGUOUS || H5Pget_external_count(properties.id()) != 0)
    refuse(name, "is not stored contiguously", "repack it: h5repack -l CONTI");
  const hsize_t row_bytes = H5Tget_size(stored.id()) * static_cast<hsize_t>(width);
  const auto room = static_cast<hsize_t>(file_bytes_);
  if (row_bytes == 0 || extent[0] > room / row_bytes ||
      (extent[0] > 0 && H5Dget_storage_size(column.dataset.id()) != extent[0] * row_bytes))
    refuse(name, fmt::format("claims {} rows, more than the file has", extent[0]));
  column.rows = static_cast<GlobalIndex>(extent[0]);
  return column;
}

Column Reader::open_column(const std::string &name, hid_t type, GlobalIndex rows, int width) const {
  Column column = open_column_of_any_length(name, type, width);
  if (column.rows != rows)
    refuse(name, fmt::format("has {} rows where the other datasets imply {}", column.rows, rows));
  return column;
}

template <class T> std::vector<T> Reader::contents(const std::string &name, int width) const {
  const Column column = open_column_of_any_length(name, NumberType<T>::stored(), width);
  std::vector<T> values(at(column.rows * width));
  if (!values.empty())
    hdf5::read_rows(column, NumberType<T>::native(), 0, column.rows, values.data());
  return values;
}

std::vector<GlobalIndex> Reader::read_offsets(const std::string &name, int slabs) const {
  std::vector<GlobalIndex> values = contents<std::int64_t>(name);
  if (values.size() != at(slabs) + 1)
    refuse(name, fmt::format("has {} rows for {} slabs", values.size(), slabs));
  if (values.front() != 0)
    refuse(name, "does not begin with 0");
  for (std::size_t s = 1; s < values.size(); ++s)
    if (values[s] < values[s - 1])
      refuse(fmt::format("{}, row {}", name, s),
             fmt::format("falls from {} to {}", values[s - 1], values[s]));
  return values;
}

namespace {

Handle open_attribute(hid_t file, const std::string &object, const char *name, const std::string &place) {
  return {H5Aopen_by_name(file, object.c_str(), name, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, "is missing",
          place};
}

bool is_scalar(const Handle &attribute, const std::string &place) {
  const Handle space(H5Aget_space(attribute.id()), H5Sclose, "cannot tell its extent", place);
  return H5Sget_simple_extent_npoints(space.id()) == 1;
}

std::string without_padding(std::string text) {
  text.resize(std::min(text.size(), text.find('\0')));
  return text;
}

constexpr std::size_t longest_text = 65536; // an attribute is no longer

} // namespace

template <class T> T Reader::number(const std::string &object, const char *name) const {
  const std::string place = fmt::format("{}, attribute {}", object, name);
  const Handle attribute = open_attribute(file_.id(), object, name, place);
  const Handle type(H5Aget_type(attribute.id()), H5Tclose, "cannot tell its type", place);
  if (H5Tequal(type.id(), NumberType<T>::stored()) <= 0 || !is_scalar(attribute, place))
    refuse(place, "is not the number that a mesh file has");
  T value{};
  hdf5::check(H5Aread(attribute.id(), NumberType<T>::native(), &value), "cannot be read", place);
  return value;
}

std::string Reader::text(const std::string &object, const char *name) const {
  const std::string place = fmt::format("{}, attribute {}", object, name);
  const Handle attribute = open_attribute(file_.id(), object, name, place);
  const Handle type(H5Aget_type(attribute.id()), H5Tclose, "cannot tell its type", place);
  const std::size_t length = H5Tget_size(type.id());
  if (H5Tget_class(type.id()) != H5T_STRING || H5Tis_variable_str(type.id()) > 0 || length > longest_text ||
      !is_scalar(attribute, place))
    refuse(place, "is not a text of fixed length");
  std::string value(length, '\0');
  hdf5::check(H5Aread(attribute.id(), type.id(), value.data()), "cannot be read", place);
  return without_padding(value);
}

std::vector<std::string> Reader::texts(const std::string &name) const {
  const Column column = open_column_of_any_length(name, H5I_INVALID_HID, 1);
  const Handle type(H5Dget_type(column.dataset.id()), H5Tclose, "cannot tell its type", name);
  if (H5Tget_class(type.id()) != H5T_STRING || H5Tis_variable_str(type.id()) > 0)
    refuse(name, "is not texts of fixed length");
  const std::size_t length = H5Tget_size(type.id());
  std::string padded(length * at(column.rows), '\0');
  if (!padded.empty())
    hdf5::read_rows(column, type.id(), 0, column.rows, padded.data());
  std::vector<std::string> values;
  for (std::size_t begin = 0; begin < padded.size(); begin += length)
    values.push_back(without_padding(padded.substr(begin, length)));
  return values;
}

std::vector<CoordinateSystemRecord> Reader::records() const {
  std::vector<CoordinateSystemRecord> records;
  for (std::string name; exists(name = fmt::format("{}/{}", records_group, records.size()));) {
    CoordinateSystemRecord record;
    record.bytes = contents<std::uint8_t>(name);
    record.user_id = text(name, "user_id");
    record.record_id = number<std::uint16_t>(name, "record_id");
    record.description = text(name, "description");
    records.push_back(std::move(record));
  }
  return records;
}

void Reader::check_ours() const {
  if (!exists(vtk_group) || !exists(own_group))
    refuse({}, "is an HDF5 file, but not a mesh made by dovetail",
           "name a mesh made by dovetail triangulate");
}

void Reader::check_version(const Header &header) const {
  if (header.format_version > mesh_format_version)
    refuse(
        {},
        fmt::format("is in mesh format {}, written by dovetail {}; this is dovetail {}, which reads formats "
                    "up to {}",
                    header.format_version, header.program_version, DOVETAIL_VERSION, mesh_format_version),
        "read it with a newer dovetail, or make the mesh again with this one");
  if (header.format_version < 1)
    refuse({}, fmt::format("says it is in mesh format {}, which there never was", header.format_version));
}

void Reader::read_extents(Header &header) const {
  Extents &extents = header.extents;
  const std::vector<std::int64_t> own = contents<std::int64_t>(own_counts);
  if (own.size() >= at(std::numeric_limits<int>::max()))
    refuse(own_counts, "has too many slabs");
  const int slabs = static_cast<int>(own.size());
  extents.sites = read_offsets(site_offsets, slabs);
  extents.triangles = read_offsets(triangle_offsets, slabs);
  extents.paths = read_offsets(path_offsets, slabs);
  extents.duplicates = read_offsets(duplicate_offsets, slabs);
  const auto counts = [&](const char *name) {
    std::vector<std::int64_t> values = contents<std::int64_t>(name);
    if (values.size() != at(slabs))
      refuse(name, fmt::format("has {} rows for {} slabs", values.size(), slabs));
    return values;
  };
  const std::vector<std::int64_t> vertices = counts(number_of_points);
  const std::vector<std::int64_t> triangles = counts(number_of_cells);
  const std::vector<std::int64_t> ids = counts(number_of_connectivity_ids);
  constexpr std::int64_t most_vertices = std::numeric_limits<LocalIndex>::max();
  for (std::size_t s = 0; s < at(slabs); ++s) {
    const auto contradiction = [&](const char *name, std::int64_t value) {
      refuse(fmt::format("{}, row {}", name, s),
             fmt::format("is {}, which contradicts other datasets", value));
    };
    if (own[s] != extents.sites[s + 1] - extents.sites[s])
      contradiction(own_counts, own[s]);
    if (vertices[s] < own[s] || vertices[s] > most_vertices)
      contradiction(number_of_points, vertices[s]);
    if (triangles[s] != extents.triangles[s + 1] - extents.triangles[s] || triangles[s] > most_vertices / 3)
      contradiction(number_of_cells, triangles[s]);
    if (ids[s] != 3 * triangles[s])
      contradiction(number_of_connectivity_ids, ids[s]);
    extents.vertices.push_back(extents.vertices.back() + vertices[s]);
  }
}

/// Numbers from `low` to below `end` that fit into a LocalIndex.
std::vector<LocalIndex> Reader::indices(const std::string &name, GlobalIndex low, GlobalIndex end,
                                        int width) const {
  const std::vector<std::int64_t> read = contents<std::int64_t>(name, width);
  std::vector<LocalIndex> values;
  values.reserve(read.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    if (read[i] < low || read[i] >= end)
      refuse(fmt::format("{}, row {}", name, i / at(width)),
             fmt::format("is {}, which is not from {} to {}", read[i], low, end - 1));
    values.push_back(static_cast<LocalIndex>(read[i]));
  }
  return values;
}

DomainRecord Reader::read_domain(const Header &header) const {
  if (header.extents.slabs() != 1)
    refuse(domain_group,
           fmt::format("is there in a mesh of {} slabs, and domains have one", header.extents.slabs()));
  const GlobalIndex sites = header.extents.sites.back();
  constexpr GlobalIndex any = std::numeric_limits<LocalIndex>::max();
  DomainRecord domain;
  domain.even_odd = number<std::int64_t>(domain_group, "even_odd") != 0;
  domain.hull_segments = number<std::int64_t>(domain_group, "hull_segments");
  domain.given_vertices = number<std::int64_t>(domain_group, "given_vertices");
  domain.min_angle = number<double>(domain_group, "min_angle");
  const std::vector<LocalIndex> ends = indices(segments, 0, sites, 2);
  const auto markers = contents<std::int32_t>(segment_markers);
  if (markers.size() != ends.size() / 2)
    refuse(segment_markers, fmt::format("has {} rows for {} segments", markers.size(), ends.size() / 2));
  for (std::size_t s = 0; s < markers.size(); ++s)
    domain.segments.push_back({ends[2 * s], ends[2 * s + 1], markers[s]});
  const auto count = static_cast<GlobalIndex>(markers.size());
  if (domain.hull_segments < 0 || domain.hull_segments > count)
    refuse(domain_group,
           fmt::format("says that {} of {} segments are hull edges", domain.hull_segments, count));
  domain.is_line = contents<std::uint8_t>(is_line);
  if (!domain.is_line.empty() &&
      static_cast<GlobalIndex>(domain.is_line.size()) != count - domain.hull_segments)
    refuse(is_line, fmt::format("has {} rows for {} segments", domain.is_line.size(), count));
  const auto hole_places = contents<double>(holes, 2);
  for (std::size_t i = 0; i < hole_places.size(); i += 2)
    domain.holes.push_back({hole_places[i], hole_places[i + 1]});
  const auto rows = contents<double>(regions, 4);
  for (std::size_t i = 0; i < rows.size(); i += 4)
    domain.regions.push_back({{rows[i], rows[i + 1]}, rows[i + 2], rows[i + 3]});
  domain.chain_vertices = indices(chain_vertices, 0, sites);
  domain.chain_offsets = indices(chain_offsets, 0, any);
  if (domain.chain_offsets.empty() || domain.chain_offsets.front() != 0 ||
      !std::ranges::is_sorted(domain.chain_offsets) ||
      at(domain.chain_offsets.back()) != domain.chain_vertices.size())
    refuse(chain_offsets, "does not divide the vertices of chains");
  domain.left_triangles = indices(left_triangles, 0, header.extents.triangles.back());
  return domain;
}

void Reader::read_sides(const Header &header, DomainRecord &domain) const {
  const auto triangles = at(header.extents.triangles.back());
  domain.segment_of_side = contents<std::int32_t>(segment_of_side, 3);
  domain.region = contents<std::int32_t>(region_of_cell);
  if (domain.segment_of_side.size() != 3 * triangles)
    refuse(segment_of_side,
           fmt::format("has {} rows for {} triangles", domain.segment_of_side.size() / 3, triangles));
  if (domain.region.size() != triangles)
    refuse(region_of_cell, fmt::format("has {} rows for {} triangles", domain.region.size(), triangles));
}

Header Reader::read_header() const {
  check_ours();
  Header header;
  const auto version = number<std::int64_t>(own_group, "format_version");
  constexpr std::int64_t representable = std::numeric_limits<int>::max();
  header.format_version = static_cast<int>(std::clamp<std::int64_t>(version, 0, representable));
  header.program_version = text(own_group, "program_version");
  check_version(header); // before all else: a newer format may have anything else
  const std::string axis = text(own_group, "axis");
  if (axis != "x" && axis != "y")
    refuse(fmt::format("{}, attribute axis", own_group), "is neither x nor y");
  header.axis = axis == "x" ? Axis::x : Axis::y;
  header.checksum = number<std::uint64_t>(own_group, "checksum");
  header.hull_edges = number<std::int64_t>(own_group, "hull_edges");
  header.digest.points = number<std::int64_t>(own_group, "digest_points");
  header.digest.hash = number<std::uint64_t>(own_group, "digest_hash");
  read_extents(header);
  header.lines = contents<double>(lines);
  const int slabs = header.extents.slabs();
  if (header.lines.size() != at(std::max(0, slabs - 1)))
    refuse(lines, fmt::format("has {} rows for {} slabs", header.lines.size(), slabs));
  header.attribute_names = texts(attribute_names);
  header.coordinate_system = records();
  if (exists(domain_group))
    header.domain = read_domain(header);
  return header;
}

} // namespace dovetail::vtkhdf
