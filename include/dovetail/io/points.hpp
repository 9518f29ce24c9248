/// Point files: reading them in parallel into a PointTable, writing them, saying what is in them.
///
/// Formats, known by extension (in small or capital letters):
///   .las  ASPRS LAS 1.0 to 1.4, point formats 0 to 10, uncompressed (io/las.hpp)
///   .npy  NumPy arrays, little endian: N x k of float64 or float32, k >= 2, or N records with the fields x
///         and y (io/npy.hpp)
///   .f64  x, y, x, y, ... as little-endian doubles, nothing else; an empty file has no points
///   .xyz .csv .txt  one point a line: x y [z ...], with or without a line of names (io/text.hpp)
///   .node Triangle's vertices: numbered, with attributes and boundary markers (io/text.hpp)
/// All columns besides x and y are carried along as attributes, under the name that the file has for them.
/// Where it has none, the third column is "z", and those behind it are "column 4", "column 5", ...; in a
/// .node file "attribute 1", "attribute 2", ... and "marker". x, y and z must be finite; other attributes
/// may be NaN, which says that there is no value.
///
/// The input index counts all records of all files in the order given, from 0; for LAS that includes the
/// records that are skipped, in text it leaves out blank lines, comments and the line of names. So it is
/// also the number of the point in its file, less the records of the files before.
#pragma once

#include "dovetail/base/error.hpp"
#include "dovetail/base/point_table.hpp"
#include "dovetail/base/progress.hpp"
#include "dovetail/comm/communicator.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dovetail {

enum class PointFormat : std::uint8_t { las, npy, f64, text, node };

/// What an extension stands for: the one table of formats.
struct PointExtension {
  std::string_view extension; ///< in small letters, with the dot
  PointFormat format;
  bool written; ///< by write_points
};
std::span<const PointExtension> point_extensions();
/// Those in a sentence: ".las, .npy and .f64".
std::string known_point_extensions(bool written_only = false);

/// By the extension of the name; nothing if it is none of ours.
std::optional<PointFormat> point_format_of(std::string_view path);

/// What a LAS header says beyond what all formats have in common.
struct LasHeader {
  int version_minor = 0; ///< 1.0 to 1.4
  int point_format = 0;  ///< 0 to 10
  std::array<double, 3> scale{}, offset{};
  std::array<double, 3> lowest{}, highest{}; ///< the bounding box as claimed, x, y, z
};

enum class NumberType : std::uint8_t { float64, float32, int8, int16, int32, uint8, uint16, uint32 };
int bytes_of(NumberType type);

/// A number that every record has.
struct PointColumn {
  std::string name; ///< "x", "y", or the attribute's
  NumberType type = NumberType::float64;
  std::int64_t place = 0; ///< bytes from the beginning of its record; text: its field in the line, from 0
};

/// What the header of a point file says, and how its records lie: column c of record i is at byte
/// first_byte + i * record_bytes + c.place, or, if `by_columns`, at
/// first_byte + c.place * records + i * (bytes of its type).
/// Text and .node: the lines begin at first_byte; record_bytes is a guess of the mean length of a line.
struct PointFile {
  std::string path;
  PointFormat format = PointFormat::f64;
  std::int64_t file_bytes = 0;
  std::int64_t first_byte = 0;
  std::int64_t record_bytes = 0;
  GlobalIndex records = 0;          ///< text, before it has been read: -1
  bool by_columns = false;          ///< NPY in Fortran order
  bool has_fields = false;          ///< NPY of records with named fields
  std::vector<PointColumn> columns; ///< x, y, z if there is one, then the other attributes
  LasHeader las;
  char separator = ' '; ///< text: ' ' (blanks and tabs), ',' or ';'
  int fields = 0;       ///< text: numbers in a line
  bool named = false;   ///< text: there is a line of names
  std::vector<CoordinateSystemRecord> coordinate_system;

  bool is_text() const { return format == PointFormat::text || format == PointFormat::node; }
  bool has(std::string_view attribute) const;
};

struct PointReading {
  std::vector<int> classes; ///< LAS: only points of these classes (0 to 255); empty: all
  /// Records pass through a buffer of about this size (at least one record or line).
  std::int64_t buffer_bytes = std::int64_t{4} << 20;
  Progress progress = {}; ///< stage "read": how much of this rank's part
};

/// What became of the records of one file.
struct PointFileCount {
  PointFile file;
  GlobalIndex first_index = 0; ///< input index of its record 0
  GlobalIndex read = 0;        ///< points taken
  GlobalIndex withheld = 0;    ///< LAS: skipped because marked as withheld
  GlobalIndex other_class = 0; ///< LAS: not withheld, skipped because of PointReading::classes
};

/// An attribute that some files have and others have not.
struct AbsentAttribute {
  std::string name;
  GlobalIndex points = 0; ///< that were given z = 0, or another attribute as NaN, because their file has none
};

/// The points of this rank; all else is the same on all ranks.
struct PointInput {
  PointTable points;                                   ///< by ascending input index, also from rank to rank
  GlobalIndex records = 0;                             ///< of all files
  GlobalIndex read = 0, withheld = 0, other_class = 0; ///< records = read + withheld + other_class
  std::vector<AbsentAttribute> absent;
  /// Those of all files, each once. Empty for files without.
  std::vector<CoordinateSystemRecord> coordinate_system;
  bool mixed_coordinate_systems = false; ///< some files have other records than others
  std::vector<PointFileCount> files;
};

/// Collective. Reads all records of all files through a small buffer, every rank a range of bytes: of text
/// the lines that begin in it. Ranks get the same number of points (but for one); with text, whose records
/// are counted only by reading them, about the same. -0.0 becomes 0.0.
/// Attributes: "z" first, then all that any file has, in order of first appearance.
/// Errors (input): unknown extension, missing, unreadable, truncated, malformed, compressed, a coordinate
/// that is NaN or infinite; in text the place is line and character, both counted from 1.
/// (usage): a class that is none, classes asked of a file that has none.
PointInput read_points(const Communicator &comm, std::span<const std::string> paths,
                       const PointReading &reading = {});

/// Local. The header of a file, checked against its length; the lines of a text are counted, but not read as
/// numbers. Errors as in read_points.
PointFile describe_points(const std::string &path);

/// The same for people, a line for each fact.
std::vector<std::string> description_lines(const PointFile &file);
/// One line for people: what the record is, with the EPSG codes or the beginning of its text.
std::string description_line(const CoordinateSystemRecord &record);

struct PointWriting {
  /// Records pass through a buffer of this size (at least one record), and no single write is larger.
  std::int64_t buffer_bytes = std::int64_t{4} << 20;
  /// A rank keeps so much text from measuring it to writing it; what is beyond is made twice.
  std::int64_t kept_bytes = std::int64_t{256} << 20;
  Progress progress = {}; ///< stage "write": how much of this rank's part
};

/// Collective. Writes the points with all attributes in the order of the ranks; written aside and renamed
/// (io/output_file.hpp). Input indices are not written.
///   .npy   N x 2, N x 3 with z alone, and with other attributes records with named fields
///   .f64   no attributes
///   .csv   commas, below a line of names
///   .xyz .txt  blanks, no names: attributes come back as z, column 4, ...
///   .node  from vertex 0 on; an attribute "marker" of whole numbers becomes the boundary marker
/// Text has the fewest digits that read back to the same numbers.
/// Errors (usage): another extension, attributes that the format cannot hold. (output): as OutputFile.
void write_points(const Communicator &comm, const PointTable &points, const std::string &path,
                  const PointWriting &writing = {});

} // namespace dovetail
