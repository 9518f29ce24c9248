// Which point files there are, and what their headers say.
#include "dovetail/io/input_file.hpp"
#include "dovetail/io/las.hpp"
#include "dovetail/io/npy.hpp"
#include "dovetail/io/points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

namespace dovetail {
namespace {

std::string extension_of(std::string_view path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

PointFile read_f64_header(const InputFile &file) {
  constexpr std::int64_t pair = 2 * sizeof(double);
  PointFile result;
  result.path = file.path();
  result.format = PointFormat::f64;
  result.file_bytes = file.bytes();
  result.record_bytes = pair;
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
  const std::string extension = extension_of(path);
  throw Error({ErrorKind::input, path, "",
               extension.empty() ? "has no extension that says what it is"
                                 : fmt::format("'{}' is not the extension of a point file", extension),
               "known are .las, .npy and .f64"});
}

} // namespace

std::optional<PointFormat> point_format_of(std::string_view path) {
  const std::string extension = extension_of(path);
  if (extension == ".las")
    return PointFormat::las;
  if (extension == ".npy")
    return PointFormat::npy;
  if (extension == ".f64")
    return PointFormat::f64;
  return std::nullopt;
}

PointFile describe_points(const std::string &path) {
  const std::optional<PointFormat> format = point_format_of(path);
  if (!format)
    refuse_extension(path);
  const InputFile file(path);
  switch (*format) {
  case PointFormat::las:
    return read_las_header(file);
  case PointFormat::npy:
    return read_npy_header(file);
  case PointFormat::f64:
    break;
  }
  return read_f64_header(file);
}

} // namespace dovetail
