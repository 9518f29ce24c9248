// Point files and coordinate systems in words.
#include "dovetail/base/excerpt.hpp"
#include "dovetail/io/las.hpp"
#include "dovetail/io/little_endian.hpp"
#include "dovetail/io/points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace dovetail {
namespace {

std::string line(std::string_view label, const std::string &value) {
  return fmt::format("{:<18} {}", label, value);
}

std::string npy_text(const PointFile &file) {
  if (file.has_fields)
    return fmt::format("NPY, records of {} bytes with named fields", file.record_bytes);
  return fmt::format("NPY, float{}, {} order", 8 * bytes_of(file.columns.front().type),
                     file.by_columns ? "Fortran" : "C");
}

std::string text_text(const PointFile &file) {
  const char *const separator = file.separator == ','   ? "commas"
                                : file.separator == ';' ? "semicolons"
                                                        : "blanks";
  return fmt::format("text, {} columns separated by {}{}", file.fields, separator,
                     file.named ? ", with a line of names" : "");
}

std::string attributes_text(const PointFile &file) {
  std::string text;
  for (std::size_t column = 2; column < file.columns.size(); ++column)
    text += (text.empty() ? "" : ", ") + excerpt(file.columns[column].name);
  return text.empty() ? "none" : text;
}

std::string format_text(const PointFile &file) {
  switch (file.format) {
  case PointFormat::las:
    return fmt::format("LAS 1.{}, point format {}", file.las.version_minor, file.las.point_format);
  case PointFormat::npy:
    return npy_text(file);
  case PointFormat::text:
    return text_text(file);
  case PointFormat::node:
    return "vertices of Triangle, as text";
  case PointFormat::f64:
    break;
  }
  return "pairs of little-endian doubles";
}

// The EPSG codes in a GeoTIFF key directory (OGC 19-008r4): four 16-bit words for the directory, then four
// for each key; a key whose second word is 0 has its value in the fourth.
std::string geotiff_codes(const std::vector<std::uint8_t> &bytes) {
  const auto word = [&](std::size_t i) {
    return load_little<std::uint16_t>(reinterpret_cast<const std::byte *>(bytes.data()) + 2 * i);
  };
  constexpr std::uint16_t geographic = 2048, projected = 3072, vertical = 4096, user_defined = 32767;
  std::string codes;
  for (std::size_t key = 4; 2 * (key + 4) <= bytes.size(); key += 4) {
    const std::uint16_t id = word(key), code = word(key + 3);
    const bool wanted = id == geographic || id == projected || id == vertical;
    if (wanted && word(key + 1) == 0 && code != 0 && code != user_defined)
      codes += fmt::format("{}EPSG:{}", codes.empty() ? "" : " ", code);
  }
  return codes;
}

} // namespace

std::string description_line(const CoordinateSystemRecord &record) {
  constexpr std::uint16_t wkt = 2112, geotiff_keys = 34735, geotiff_text = 34737;
  std::string detail = record.description;
  if (record.record_id == geotiff_keys)
    detail = geotiff_codes(record.bytes);
  if (record.record_id == wkt || record.record_id == geotiff_text) {
    detail.assign(record.bytes.begin(), record.bytes.end());
    detail.resize(std::min(detail.find('\0'), detail.size()));
  }
  std::replace(detail.begin(), detail.end(), '\n', ' '); // between the keys of a pretty-printed text
  return fmt::format("{} {}, {} bytes{}{}", excerpt(record.user_id), record.record_id, record.bytes.size(),
                     detail.empty() ? "" : ": ", excerpt(detail));
}

std::vector<std::string> description_lines(const PointFile &file) {
  std::vector<std::string> lines;
  lines.push_back(line("format", format_text(file)));
  lines.push_back(line("points", fmt::format("{}", file.records)));
  if (file.format == PointFormat::text)
    lines.push_back(line(
        "x and y", fmt::format("columns {} and {}", file.columns[0].place + 1, file.columns[1].place + 1)));
  lines.push_back(line("attributes", attributes_text(file)));
  if (file.format == PointFormat::las) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      lines.push_back(line(fmt::format("{} (in the header)", "xyz"[axis]),
                           fmt::format("{} to {}", file.las.lowest[axis], file.las.highest[axis])));
    const auto &scale = file.las.scale;
    lines.push_back(line("scale", fmt::format("{} {} {}", scale[0], scale[1], scale[2])));
    lines.push_back(line("record", fmt::format("{} bytes, {} of them extra", file.record_bytes,
                                               file.record_bytes - las_record_bytes(file.las.point_format))));
  }
  for (const CoordinateSystemRecord &record : file.coordinate_system)
    lines.push_back(line("coordinate system", description_line(record)));
  lines.push_back(line("file", fmt::format("{} bytes", file.file_bytes)));
  return lines;
}

} // namespace dovetail
