/// Point files: reading them in parallel into a PointTable, writing them, saying what is in them.
///
/// Formats, known by extension (in small or capital letters):
///   .las  ASPRS LAS 1.0 to 1.4, point formats 0 to 10, uncompressed (io/las.hpp)
///   .npy  NumPy arrays of float64 or float32, little endian, N x 2 or N x 3 (io/npy.hpp)
///   .f64  x, y, x, y, ... as little-endian doubles, nothing else; an empty file has no points
/// A third column is the attribute "z".
///
/// The input index counts all records of all files in the order given, from 0; for LAS that includes the
/// records that are skipped. So it is also the number of the point in its file, less the records of the
/// files before.
#pragma once

#include "dovetail/base/error.hpp"
#include "dovetail/base/point_table.hpp"
#include "dovetail/comm/communicator.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dovetail {

enum class PointFormat : std::uint8_t { las, npy, f64 };

/// By the extension of the name; nothing if it is none of ours.
std::optional<PointFormat> point_format_of(std::string_view path);

/// What a LAS header says beyond what all formats have in common.
struct LasHeader {
  int version_minor = 0; ///< 1.0 to 1.4
  int point_format = 0;  ///< 0 to 10
  std::array<double, 3> scale{}, offset{};
  std::array<double, 3> lowest{}, highest{}; ///< the bounding box as claimed, x, y, z
};

/// What the header of a point file says, and how its records lie: coordinate c of record i is at byte
/// first_byte + i * record_bytes + c * number_bytes, or, if `by_columns`, at
/// first_byte + (c * records + i) * number_bytes.
struct PointFile {
  std::string path;
  PointFormat format = PointFormat::f64;
  std::int64_t file_bytes = 0;
  std::int64_t first_byte = 0;
  std::int64_t record_bytes = 0;
  GlobalIndex records = 0;
  int columns = 2;         ///< 3 with z
  int number_bytes = 8;    ///< of one coordinate
  bool by_columns = false; ///< NPY in Fortran order
  LasHeader las;
  std::vector<CoordinateSystemRecord> coordinate_system;
};

struct PointReading {
  std::vector<int> classes; ///< LAS: only points of these classes (0 to 255); empty: all
  /// Records pass through a buffer of about this size (at least one record).
  std::int64_t buffer_bytes = std::int64_t{4} << 20;
};

/// What became of the records of one file.
struct PointFileCount {
  PointFile file;
  GlobalIndex first_index = 0; ///< input index of its record 0
  GlobalIndex read = 0;        ///< points taken
  GlobalIndex withheld = 0;    ///< LAS: skipped because marked as withheld
  GlobalIndex other_class = 0; ///< LAS: not withheld, skipped because of PointReading::classes
};

/// The points of this rank; all else is the same on all ranks.
struct PointInput {
  PointTable points;                                   ///< by ascending input index, also from rank to rank
  GlobalIndex records = 0;                             ///< of all files
  GlobalIndex read = 0, withheld = 0, other_class = 0; ///< records = read + withheld + other_class
  GlobalIndex without_z = 0; ///< points that were given z = 0 because other files have a z and theirs not
  /// Those of all files, each once. Empty for files without.
  std::vector<CoordinateSystemRecord> coordinate_system;
  bool mixed_coordinate_systems = false; ///< some files have other records than others
  std::vector<PointFileCount> files;
};

/// Collective. Reads all records of all files, the same number (but for one) on every rank, through a small
/// buffer. -0.0 becomes 0.0.
/// Errors (input): unknown extension, missing, unreadable, truncated, malformed, compressed, a coordinate
/// that is NaN or infinite. (usage): a class that is none, classes asked of a file that has none.
PointInput read_points(const Communicator &comm, std::span<const std::string> paths,
                       const PointReading &reading = {});

/// Local. The header of a file, checked against its length. Errors as in read_points.
PointFile describe_points(const std::string &path);

/// The same for people, a line for each fact.
std::vector<std::string> description_lines(const PointFile &file);
/// One line for people: what the record is, with the EPSG codes or the beginning of its text.
std::string description_line(const CoordinateSystemRecord &record);

struct PointWriting {
  /// Records pass through a buffer of this size, and no single write is larger.
  std::int64_t buffer_bytes = std::int64_t{4} << 20;
};

/// Collective. Writes the points, and their z if there is one, to a `.npy` or `.f64` file, in the order of
/// the ranks; written aside and renamed (io/output_file.hpp). Input indices are not written.
/// Errors (usage): another extension, attributes that the format cannot hold. (output): as OutputFile.
void write_points(const Communicator &comm, const PointTable &points, const std::string &path,
                  const PointWriting &writing = {});

} // namespace dovetail
