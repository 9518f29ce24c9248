// Which point files there are, and what their headers say.
#include "points_share.hpp"

#include "dovetail/io/domain.hpp"
#include "dovetail/io/las.hpp"
#include "dovetail/io/npy.hpp"
#include "dovetail/io/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>

namespace dovetail {
namespace {

constexpr std::array<PointExtension, 7> extensions{{{".las", PointFormat::las, false},
                                                    {".npy", PointFormat::npy, true},
                                                    {".f64", PointFormat::f64, true},
                                                    {".xyz", PointFormat::text, true},
                                                    {".csv", PointFormat::text, true},
                                                    {".txt", PointFormat::text, true},
                                                    {".node", PointFormat::node, true}}};

PointFile read_f64_header(const InputFile &file) {
  constexpr std::int64_t pair = 2 * sizeof(double);
  PointFile result;
  result.path = file.path();
  result.format = PointFormat::f64;
  result.file_bytes = file.bytes();
  result.record_bytes = pair;
  result.columns = {{"x", NumberType::float64, 0}, {"y", NumberType::float64, sizeof(double)}};
  result.records = file.bytes() / pair;
  if (file.bytes() % pair != 0)
    file.refuse(
        result.records * pair,
        fmt::format("{} bytes are left over after {} pairs of doubles", file.bytes() % pair, result.records),
        "a .f64 file is x, y, x, y, ... as 8-byte little-endian numbers: write it again");
  return result;
}

[[noreturn]] void refuse_extension(const std::string &path) {
  if (extension_of(path) == ".laz")
    throw Error({ErrorKind::input, path, "", "compressed LAS is not read", unpacking_advice(path)});
  if (is_domain_file(path))
    throw Error({ErrorKind::input, path, "", "holds a domain, and points are asked for",
                 "domains are for dovetail constrain and dovetail refine"});
  const std::string extension = extension_of(path);
  throw Error({ErrorKind::input, path, "",
               extension.empty() ? "has no extension that says what it is"
                                 : fmt::format("'{}' is not the extension of a point file", extension),
               "known are " + known_point_extensions()});
}

} // namespace

std::string extension_of(std::string_view path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

std::span<const PointExtension> point_extensions() { return extensions; }

std::string known_point_extensions(bool written_only) {
  std::string names;
  std::string_view last;
  for (const PointExtension &each : extensions) {
    if (written_only && !each.written)
      continue;
    if (!last.empty())
      names += (names.empty() ? "" : ", ") + std::string(last);
    last = each.extension;
  }
  return names + " and " + std::string(last);
}

std::optional<PointFormat> point_format_of(std::string_view path) {
  const std::string extension = extension_of(path);
  for (const PointExtension &each : extensions)
    if (each.extension == extension)
      return each.format;
  return std::nullopt;
}

int bytes_of(NumberType type) {
  switch (type) {
  case NumberType::float64:
    return 8;
  case NumberType::float32:
  case NumberType::int32:
  case NumberType::uint32:
    return 4;
  case NumberType::int16:
  case NumberType::uint16:
    return 2;
  case NumberType::int8:
  case NumberType::uint8:
    break;
  }
  return 1;
}

bool PointFile::has(std::string_view attribute) const {
  return std::any_of(columns.begin(), columns.end(),
                     [attribute](const PointColumn &column) { return column.name == attribute; });
}

GlobalIndex shareable_records(const PointFile &file) {
  return file.is_text() ? (file.file_bytes - file.first_byte + file.record_bytes - 1) / file.record_bytes
                        : file.records;
}

PointFile read_header(const InputFile &file, PointFormat format) {
  switch (format) {
  case PointFormat::las:
    return read_las_header(file);
  case PointFormat::npy:
    return read_npy_header(file);
  case PointFormat::text:
    return read_text_header(file);
  case PointFormat::node:
    return read_node_header(file);
  case PointFormat::f64:
    break;
  }
  return read_f64_header(file);
}

PointFile open_points(const std::string &path) {
  const std::optional<PointFormat> format = point_format_of(path);
  if (!format)
    refuse_extension(path);
  return read_header(InputFile(path), *format);
}

PointFile describe_points(const std::string &path) {
  constexpr std::int64_t buffer_bytes = std::int64_t{1} << 20;
  PointFile result = open_points(path);
  if (result.records >= 0)
    return result;
  const InputFile file(path);
  LineReader reader(file, result.first_byte, result.first_byte, file.bytes(), buffer_bytes);
  for (result.records = 0; reader.next();)
    result.records += count_data_lines(reader.lines());
  return result;
}

} // namespace dovetail
