/// LAS 1.0 to 1.4 (ASPRS, "LAS Specification", 2003 to 2019): the LiDAR exchange format.
#pragma once

#include "dovetail/io/input_file.hpp"
#include "dovetail/io/points.hpp"

#include <cstddef>
#include <string>

namespace dovetail {

/// Local. The public header block and the coordinate system's records (user id LASF_Projection, in variable
/// length and in extended variable length records), all checked against each other and the length.
/// Errors (input): not LAS, compressed, truncated, contradictory.
PointFile read_las_header(const InputFile &file);

struct LasFlags {
  int classification;
  bool withheld;
};

/// Of the record that begins at `record`, which has the given point format.
inline LasFlags las_flags(const std::byte *record, int point_format) {
  const auto byte_at = [record](int offset) { return std::to_integer<int>(record[offset]); };
  // Formats 0 to 5 have five bits of class and three of flags in one byte; from 6 on they have a byte each.
  if (point_format <= 5)
    return {byte_at(15) & 0x1f, (byte_at(15) & 0x80) != 0};
  return {byte_at(16), (byte_at(15) & 0x04) != 0};
}

/// What to do with a compressed file.
std::string unpacking_advice(const std::string &path);

/// The bytes of a point of this format without extra bytes.
int las_record_bytes(int point_format);

} // namespace dovetail
