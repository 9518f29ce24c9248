/// Points as text, one a line: tables (.xyz, .csv, .txt) and Triangle's .node files.
///
/// Tables. Columns are separated by commas, by semicolons, or by blanks and tabs; the first line with data
/// shows by which, and how many columns there are, and every line must follow it. One separator more at the
/// end of a line does no harm. Above the data there may be one line of names: it is one if neither of its
/// first two fields is a number or begins like one. Names may stand in double quotes. Where it names a column
/// x and a column y, in small or capital letters, those are the coordinates; otherwise the first two columns
/// are. A column named z or Z, or without names the third, is z. A name that is empty, used twice, or
/// reserved for a dataset of mesh files becomes "column N"; '/' becomes '_'.
///
/// Triangle (Shewchuk): a line with the number of vertices, 2, the number of attributes, and 0 or 1 for
/// markers; then a line for each vertex: its number, x, y, attributes, marker. Numbers count up from 0 or 1.
///
/// Both. What follows # or // is a comment; blank lines do not count. Lines end with a newline, or carriage
/// return and newline; the last may lack it. A byte order mark (UTF-8) is skipped. Numbers are decimal, with
/// a sign (also +) and an exponent if need be, and are rounded correctly: to the nearest double, ties to
/// even, as in C, Python and IEEE 754. An empty field (between commas or semicolons) is NaN, as are nan and
/// NaN; inf and infinity are infinite; x, y and z must be neither. A decimal comma is refused.
#pragma once

#include "dovetail/io/input_file.hpp"
#include "dovetail/io/points.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dovetail {

/// Reads the number that begins at `text`, before the first character that cannot belong to it, such as the
/// newline that must end the text. Returns the end of it, or null if there is none. Overflow is infinite, and
/// underflow zero, with the sign. Local, as is everything here.
const char *parse_decimal(const char *text, double &value);

/// What a field of a line is for.
enum class FieldRole : std::uint8_t { x, y, z, attribute, number };

struct LineLayout {
  char separator = ' '; ///< ' ' (blanks and tabs), ',' or ';'
  std::vector<FieldRole> fields;
  bool named = false; ///< for messages: a line of names, not the first line of data, says how many fields
};

/// Thrown by parse_lines: what is wrong with the character at `offset`.
struct LineFault {
  std::size_t offset;
  std::string what, remedy;
};

/// Appends the numbers of all lines of data, line by line. `lines` ends with a newline.
void parse_lines(std::string_view lines, const LineLayout &layout, std::vector<double> &numbers);

/// How many lines are neither blank nor a comment. `lines` ends with a newline.
GlobalIndex count_data_lines(std::string_view lines);

/// Where the data of line `record` (of those with data, from 0) begins. `lines` ends with a newline.
std::size_t offset_of_data_line(std::string_view lines, GlobalIndex record);

/// The lines of a file that begin in [begin, end), in blocks of about buffer_bytes; a block grows for a line
/// that is longer. A line begins at `first_line`, at or before `begin`, and behind every newline.
class LineReader {
public:
  LineReader(const InputFile &file, std::int64_t first_line, std::int64_t begin, std::int64_t end,
             std::int64_t buffer_bytes);

  /// False at the end. Errors (input): as InputFile::read_at, a line of more than 16 MiB.
  bool next();
  /// Some whole lines, each with its newline, also the last of a file that lacks it.
  std::string_view lines() const { return {buffer_.data(), given_}; }
  /// Where they begin in the file.
  std::int64_t offset() const { return base_; }

private:
  void drop_given();
  void fill();
  void skip_line();
  std::size_t whole_lines() const;

  const InputFile &file_;
  std::int64_t end_;
  std::int64_t base_; // byte of the file that is the first in the buffer
  std::vector<char> buffer_;
  std::size_t filled_ = 0; // bytes of the buffer that hold something
  std::size_t given_ = 0;  // of these, those of lines()
  bool inside_line_;       // the buffer begins in the middle of a line of somebody else
  bool done_ = false;
};

/// An Error about the character at `byte` of a text, with its line and place in the line. Reads the file up
/// to there to count lines.
[[noreturn]] void refuse_text(const InputFile &file, std::int64_t byte, const std::string &what,
                              const std::string &remedy);

/// The beginning of a file, up to the first line of data. Errors (input): nothing that can be points.
PointFile read_text_header(const InputFile &file);
PointFile read_node_header(const InputFile &file);

LineLayout line_layout(const PointFile &file);

} // namespace dovetail
