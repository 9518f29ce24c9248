/// The parts of reading points that know nothing of ranks: headers, and ranges of records into a table.
#pragma once

#include "dovetail/base/progress.hpp"
#include "dovetail/io/input_file.hpp"
#include "dovetail/io/points.hpp"

#include <bitset>
#include <string>
#include <string_view>
#include <vector>

namespace dovetail {

/// Local, as is everything here. With the dot, in small letters.
std::string extension_of(std::string_view path);

/// The header alone: records of a text are not counted.
PointFile read_header(const InputFile &file, PointFormat format);
/// The same for a name, with the format that its extension says.
PointFile open_points(const std::string &path);

/// Records first .. first + count - 1 of a file. Of a text, whose records nobody has counted, they are
/// pieces of record_bytes each, and stand for the lines that begin in them.
struct RecordRange {
  GlobalIndex first, count;
};
/// How many there are to share out.
GlobalIndex shareable_records(const PointFile &file);

/// The columns of a table that the columns of one file go to; those it has not are filled up.
class FileColumns {
public:
  /// `table` has all attributes that any file has.
  FileColumns(PointTable &table, const PointFile &file);

  PointTable &table() const { return table_; }
  /// For column c of the file, c >= 2.
  std::vector<double> &attribute(std::size_t column) const { return *into_[column - 2]; }
  /// Makes what the file has not as long as the points.
  void fill_up() const;

private:
  PointTable &table_;
  std::vector<std::vector<double> *> into_;
  struct Absent {
    std::vector<double> *values;
    double value;
  };
  std::vector<Absent> absent_;
};

using LasClasses = std::bitset<256>;

/// Records of fixed size. Input indices count in the file; `done` counts records.
void read_records(const InputFile &file, PointFileCount &input, RecordRange range, std::int64_t buffer_bytes,
                  const LasClasses &classes, const FileColumns &columns, ProgressCount &done);

/// What was found in a range of lines. In .node files vertices are to be numbered one after the other; which
/// of them breaks that is known only when those of lower ranks are counted.
struct LineCount {
  GlobalIndex lines = 0;
  double first_number = 0;
  GlobalIndex first_break = -1; ///< the first line whose number does not follow from the first one's
  double number_there = 0;
};
/// Lines of text. Input indices count in the range; `done` counts pieces of the range.
LineCount read_lines(const InputFile &file, const PointFile &layout, RecordRange range,
                     std::int64_t buffer_bytes, const FileColumns &columns, ProgressCount &done);

/// An Error about line `record` of those in the range.
[[noreturn]] void refuse_line(const InputFile &file, const PointFile &layout, RecordRange range,
                              GlobalIndex record, const std::string &what, const std::string &remedy);

} // namespace dovetail
