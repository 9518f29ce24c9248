#include "dovetail/io/las.hpp"

#include "dovetail/io/little_endian.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

namespace dovetail {
namespace {

constexpr std::string_view remake = "download or export the file again";

// Where things are in the public header block.
namespace at {
constexpr std::size_t version_major = 24, version_minor = 25, header_bytes = 94, first_point = 96,
                      record_count = 100, point_format = 104, record_bytes = 105, legacy_points = 107,
                      scale = 131, offset = 155, bounds = 179, first_extended = 235, extended_count = 243,
                      points = 247;
} // namespace at

// By minor version.
constexpr std::array<std::int64_t, 5> smallest_header = {227, 227, 227, 235, 375};
// By point format: the bytes of a record without extra bytes.
constexpr std::array<int, 11> smallest_record = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
constexpr int compression_bits = 0xc0;

// The record headers, before their own data. Reserved 2, user id 16, record id 2, length 2 or 8,
// description 32.
struct RecordHeaderShape {
  std::int64_t bytes;
  std::size_t length, description;
};
constexpr RecordHeaderShape short_record{54, 20, 22}, extended_record{60, 20, 28};

std::string text_field(std::span<const std::byte> field) {
  std::string text;
  for (const std::byte byte : field) {
    if (byte == std::byte{0})
      break;
    text += static_cast<char>(byte);
  }
  return text;
}

[[noreturn]] void refuse_header(const InputFile &file, std::size_t byte, const std::string &what) {
  file.refuse(static_cast<std::int64_t>(byte), "the LAS header is malformed: " + what, std::string(remake));
}

// Variable length records, `count` of them, back to back between begin and end. Keeps those of the
// coordinate system.
void read_records(const InputFile &file, RecordHeaderShape shape, std::int64_t begin, std::int64_t end,
                  std::uint32_t count, std::vector<CoordinateSystemRecord> &kept) {
  std::array<std::byte, 60> header;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (end - begin < shape.bytes)
      file.refuse(begin,
                  fmt::format("variable length record {} of {} does not fit before byte {}", i, count, end),
                  std::string(remake));
    file.read_at(begin, std::span(header).first(static_cast<std::size_t>(shape.bytes)));
    const std::uint64_t length = shape.bytes == short_record.bytes
                                     ? load_little<std::uint16_t>(&header[shape.length])
                                     : load_little<std::uint64_t>(&header[shape.length]);
    const std::int64_t data = begin + shape.bytes;
    if (length > static_cast<std::uint64_t>(end - data))
      file.refuse(begin,
                  fmt::format("variable length record {} claims {} bytes, past byte {}", i, length, end),
                  std::string(remake));
    begin = data + static_cast<std::int64_t>(length);
    CoordinateSystemRecord record;
    record.user_id = text_field(std::span(header).subspan(2, 16));
    if (record.user_id != "LASF_Projection")
      continue;
    record.record_id = load_little<std::uint16_t>(&header[18]);
    record.description = text_field(std::span(header).subspan(shape.description, 32));
    record.bytes.resize(static_cast<std::size_t>(length));
    file.read_at(data, std::as_writable_bytes(std::span(record.bytes)));
    kept.push_back(std::move(record));
  }
}

// The header at its largest, zero where this version has nothing.
std::vector<std::byte> read_header_bytes(const InputFile &file, int &version_minor) {
  std::vector<std::byte> header(static_cast<std::size_t>(smallest_header.back()));
  constexpr std::string_view signature = "LASF";
  const auto start = std::span(header).first(at::version_minor + 1);
  if (file.bytes() < static_cast<std::int64_t>(start.size()))
    file.refuse(file.bytes(), file.bytes() == 0 ? "the file is empty" : "the file ends inside the LAS header",
                std::string(remake));
  file.read_at(0, start);
  if (text_field(start.first(signature.size())) != signature)
    file.refuse(0, "this is not a LAS file: it does not begin with LASF", "check what the file is");
  version_minor = std::to_integer<int>(header[at::version_minor]);
  const int version_major = std::to_integer<int>(header[at::version_major]);
  if (version_major != 1 || version_minor > 4)
    file.refuse(at::version_major, fmt::format("LAS {}.{} is not known", version_major, version_minor),
                "convert it to LAS 1.4");
  const std::int64_t needed = smallest_header[static_cast<std::size_t>(version_minor)];
  if (file.bytes() < needed)
    file.refuse(file.bytes(), "the file ends inside the LAS header", std::string(remake));
  file.read_at(0, std::span(header).first(static_cast<std::size_t>(needed)));
  const auto claimed = load_little<std::uint16_t>(&header[at::header_bytes]);
  if (claimed < needed)
    refuse_header(
        file, at::header_bytes,
        fmt::format("it claims {} bytes, and version 1.{} has at least {}", claimed, version_minor, needed));
  return header;
}

void take_point_format(PointFile &result, const InputFile &file, const std::byte *header) {
  const int byte = std::to_integer<int>(header[at::point_format]);
  if ((byte & compression_bits) != 0)
    file.refuse(at::point_format, "the points are compressed (LAZ)", unpacking_advice(file.path()));
  if (byte >= static_cast<int>(smallest_record.size()))
    file.refuse(at::point_format, fmt::format("point format {} is not known", byte),
                "convert it to a point format from 0 to 10");
  result.las.point_format = byte;
  if (byte >= 6 && result.las.version_minor < 4)
    refuse_header(
        file, at::point_format,
        fmt::format("point format {} needs LAS 1.4, and this is 1.{}", byte, result.las.version_minor));
  result.record_bytes = load_little<std::uint16_t>(&header[at::record_bytes]);
  if (result.record_bytes < las_record_bytes(byte))
    refuse_header(file, at::record_bytes,
                  fmt::format("records of {} bytes are too short for point format {}, which needs {}",
                              result.record_bytes, byte, las_record_bytes(byte)));
}

// LAS 1.4 counts in 64 bits, and also in the old 32 bits where the point format is old and the count fits.
GlobalIndex point_count(const PointFile &result, const InputFile &file, const std::byte *header) {
  const std::uint64_t legacy = load_little<std::uint32_t>(&header[at::legacy_points]);
  if (result.las.version_minor < 4)
    return static_cast<GlobalIndex>(legacy);
  const auto count = load_little<std::uint64_t>(&header[at::points]);
  if (count != 0 && legacy != 0 && count != legacy)
    refuse_header(file, at::points,
                  fmt::format("it counts {} points in 64 bits and {} in 32", count, legacy));
  if (count > static_cast<std::uint64_t>(file.bytes()))
    file.refuse(at::points, fmt::format("the header promises {} points, more than the file has bytes", count),
                std::string(remake));
  return static_cast<GlobalIndex>(count != 0 ? count : legacy);
}

void take_points(PointFile &result, const InputFile &file, const std::byte *header) {
  result.first_byte = load_little<std::uint32_t>(&header[at::first_point]);
  if (result.first_byte < load_little<std::uint16_t>(&header[at::header_bytes]))
    refuse_header(file, at::first_point,
                  fmt::format("points at byte {} would overlap it", result.first_byte));
  result.records = point_count(result, file, header);
  const std::int64_t room = std::max<std::int64_t>(0, file.bytes() - result.first_byte);
  if (result.records > room / result.record_bytes)
    file.refuse(file.bytes(),
                fmt::format("the file ends here, with {} of the {} points that its header promises",
                            room / result.record_bytes, result.records),
                std::string(remake));
  // In LAS 1.0 two signature bytes precede the points, and some writers do not count them. Nothing may
  // follow the points there, so the length tells.
  if (result.las.version_minor == 0 && room == result.records * result.record_bytes + 2) {
    std::array<std::byte, 2> signature;
    file.read_at(result.first_byte, signature);
    if (load_little<std::uint16_t>(signature.data()) == 0xccdd)
      result.first_byte += 2;
  }
}

void take_transformation(PointFile &result, const InputFile &file, const std::byte *header) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    result.las.scale[axis] = load_little<double>(header + at::scale + 8 * axis);
    result.las.offset[axis] = load_little<double>(header + at::offset + 8 * axis);
    result.las.highest[axis] = load_little<double>(header + at::bounds + 16 * axis);
    result.las.lowest[axis] = load_little<double>(header + at::bounds + 16 * axis + 8);
    if (!std::isfinite(result.las.scale[axis]) || result.las.scale[axis] == 0)
      refuse_header(file, at::scale + 8 * axis,
                    fmt::format("the scale of {} is {}", "xyz"[axis], result.las.scale[axis]));
    if (!std::isfinite(result.las.offset[axis]))
      refuse_header(file, at::offset + 8 * axis,
                    fmt::format("the offset of {} is {}", "xyz"[axis], result.las.offset[axis]));
  }
}

} // namespace

std::string unpacking_advice(const std::string &path) {
  std::string unpacked = path;
  if (unpacked.size() >= 4 && unpacked[unpacked.size() - 4] == '.')
    unpacked.resize(unpacked.size() - 4);
  // A compressed file may be called .las already.
  unpacked += unpacked + ".las" == path ? ".unpacked.las" : ".las";
  return fmt::format("unpack it with \"laszip -i {0} -o {1}\" or \"pdal translate {0} {1}\"", path, unpacked);
}

int las_record_bytes(int point_format) { return smallest_record[static_cast<std::size_t>(point_format)]; }

PointFile read_las_header(const InputFile &file) {
  PointFile result;
  result.path = file.path();
  result.format = PointFormat::las;
  result.file_bytes = file.bytes();
  result.columns = {{"x", NumberType::int32, 0}, {"y", NumberType::int32, 4}, {"z", NumberType::int32, 8}};
  const std::vector<std::byte> bytes = read_header_bytes(file, result.las.version_minor);
  const std::byte *header = bytes.data();
  take_point_format(result, file, header);
  take_points(result, file, header);
  take_transformation(result, file, header);
  read_records(file, short_record, load_little<std::uint16_t>(header + at::header_bytes), result.first_byte,
               load_little<std::uint32_t>(header + at::record_count), result.coordinate_system);
  const auto extended = load_little<std::uint32_t>(header + at::extended_count);
  if (extended == 0)
    return result;
  const auto first = load_little<std::uint64_t>(header + at::first_extended);
  const std::int64_t end_of_points = result.first_byte + result.records * result.record_bytes;
  if (first < static_cast<std::uint64_t>(end_of_points) || first > static_cast<std::uint64_t>(file.bytes()))
    refuse_header(file, at::first_extended,
                  fmt::format("extended records at byte {} are not between the points and the end", first));
  read_records(file, extended_record, static_cast<std::int64_t>(first), file.bytes(), extended,
               result.coordinate_system);
  return result;
}

} // namespace dovetail
