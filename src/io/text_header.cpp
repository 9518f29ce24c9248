// How the lines of a text are to be read, from its beginning.
#include "dovetail/io/text.hpp"

#include "point_columns.hpp"

#include "dovetail/base/excerpt.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace dovetail {
namespace {

constexpr std::int64_t buffer_bytes = std::int64_t{1} << 16;
constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
constexpr const char *blanks = " \t\r\n";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(blanks);
  return first == std::string_view::npos ? std::string_view()
                                         : text.substr(first, text.find_last_not_of(blanks) + 1 - first);
}

std::string_view without_comment(std::string_view line) {
  return line.substr(0, std::min(line.find('#'), line.find("//")));
}

// A line that is neither blank nor a comment.
struct Line {
  std::string text; // with its newline
  std::int64_t offset, end;
};

// The lines of a file that have data, one after the other.
class DataLines {
public:
  explicit DataLines(const InputFile &file)
      : file_(file), first_(starts_with_mark(file) ? static_cast<std::int64_t>(byte_order_mark.size()) : 0),
        reader_(file, first_, first_, file.bytes(), buffer_bytes) {}

  std::optional<Line> next() {
    for (;;) {
      if (rest_.empty()) {
        if (!reader_.next())
          return std::nullopt;
        rest_ = reader_.lines();
        refuse_what_is_no_text();
      }
      const std::string_view line = rest_.substr(0, rest_.find('\n') + 1);
      const std::int64_t offset = reader_.offset() + (line.data() - reader_.lines().data());
      rest_.remove_prefix(line.size());
      if (count_data_lines(line) > 0)
        return Line{std::string(line), offset,
                    std::min(offset + static_cast<std::int64_t>(line.size()), file_.bytes())};
    }
  }

  // Bytes from `begin`, in what was read last, to the end of that, by its lines with data.
  std::int64_t mean_line_bytes(std::int64_t begin) const {
    const std::string_view lines = reader_.lines().substr(static_cast<std::size_t>(begin - reader_.offset()));
    const auto bytes = static_cast<std::int64_t>(lines.size());
    return std::max<std::int64_t>(1, bytes / std::max<GlobalIndex>(1, count_data_lines(lines)));
  }
  std::int64_t first_byte() const { return first_; }

private:
  void refuse_what_is_no_text() const {
    if (const std::size_t nul = rest_.find('\0'); nul != std::string_view::npos)
      file_.refuse(reader_.offset() + static_cast<std::int64_t>(nul), "the file is not text: a byte is zero",
                   "check what the file is; text must be ASCII or UTF-8 (iconv -f UTF-16 makes it)");
    // A file of one line, of names or a comment, would otherwise pass for one without points.
    for (std::size_t at = rest_.find('\r'); at != std::string_view::npos; at = rest_.find('\r', at + 1))
      if (rest_[at + 1] != '\n')
        refuse_text(file_, reader_.offset() + static_cast<std::int64_t>(at),
                    "a carriage return stands where no line ends",
                    "make newlines of the carriage returns, for instance with tr '\\r' '\\n'");
  }

  static bool starts_with_mark(const InputFile &file) {
    std::string start(std::min<std::size_t>(byte_order_mark.size(), static_cast<std::size_t>(file.bytes())),
                      ' ');
    file.read_at(0, std::as_writable_bytes(std::span(start)));
    return start == byte_order_mark;
  }

  const InputFile &file_;
  std::int64_t first_;
  LineReader reader_;
  std::string_view rest_;
};

// What stands in quotes separates nothing.
char separator_of(std::string_view line) {
  char separator = ' ';
  bool quoted = false;
  for (const char c : without_comment(line)) {
    if (c == '"')
      quoted = !quoted;
    else if (!quoted && (c == ';' || (c == ',' && separator == ' ')))
      separator = c;
  }
  return separator;
}

// Fields between separators, trimmed and without their quotes. ' ' stands for any number of blanks.
std::vector<std::string> split(std::string_view line, char separator) {
  std::vector<std::string> fields;
  std::string field;
  bool quoted = false;
  for (const char c : trimmed(line)) {
    const bool ends = !quoted && (c == separator || (separator == ' ' && c == '\t'));
    if (c == '"')
      quoted = !quoted;
    else if (!ends)
      field += c;
    if (ends && (separator != ' ' || !field.empty())) {
      fields.emplace_back(trimmed(field));
      field.clear();
    }
  }
  fields.emplace_back(trimmed(field));
  return fields;
}

bool is_number(const std::string &field) {
  double ignored = 0;
  const std::string text = field + '\n';
  return parse_decimal(text.c_str(), ignored) == text.c_str() + field.size();
}

// What begins like a number is a mistake in the data, which must not pass for a name.
bool can_be_name(const std::string &field) {
  const std::size_t first = field.find_first_not_of("+-.");
  const bool digit = first != std::string::npos && field[first] >= '0' && field[first] <= '9';
  return !digit && !is_number(field);
}

bool is_line_of_names(const Line &line) {
  const auto fields = split(without_comment(line.text), separator_of(line.text));
  return can_be_name(fields[0]) && (fields.size() < 2 || can_be_name(fields[1]));
}

// Names may have blanks in them if something else separates them.
std::vector<std::string> names_of(const Line &line, char separator) {
  if (separator == ' ' && line.text.find('\t') != std::string::npos)
    separator = '\t';
  if (separator == ' ')
    separator = separator_of(line.text);
  return split(line.text, separator);
}

// `names` is empty or has one for each field.
std::vector<PointColumn> columns_of(const std::vector<std::string> &names, int fields) {
  std::vector<PointColumn> columns;
  for (std::size_t field = 0; field < static_cast<std::size_t>(fields); ++field)
    columns.push_back(
        {names.empty() ? "" : names[field], NumberType::float64, static_cast<std::int64_t>(field)});
  return coordinates_first(std::move(columns));
}

PointFile text_file(const InputFile &file, PointFormat format, std::int64_t first_byte) {
  PointFile result;
  result.path = file.path();
  result.format = format;
  result.file_bytes = file.bytes();
  result.first_byte = first_byte;
  result.record_bytes = 1;
  result.records = -1;
  result.fields = 2;
  result.columns = columns_of({}, 2);
  return result;
}

// What the header of a .node file counts.
struct NodeCounts {
  GlobalIndex vertices = 0, dimensions = 2, attributes = 0, markers = 0;
};

NodeCounts node_counts(const InputFile &file, const Line &line) {
  constexpr GlobalIndex most_attributes = 1 << 16;
  const auto refuse = [&](const std::string &what) {
    refuse_text(file, line.offset, what,
                "begin the file with: vertices, 2, attributes of each, 0 or 1 boundary markers");
  };
  NodeCounts counts;
  const auto fields = split(without_comment(line.text), ' ');
  const std::array<GlobalIndex *, 4> into{&counts.vertices, &counts.dimensions, &counts.attributes,
                                          &counts.markers};
  if (fields.size() > into.size())
    refuse(fmt::format("the first line of a .node file has up to 4 numbers, and this has {} columns",
                       fields.size()));
  for (std::size_t i = 0; i < fields.size(); ++i) {
    double value = -1;
    if (is_number(fields[i]))
      parse_decimal((fields[i] + '\n').c_str(), value);
    if (!(value >= 0 && value <= 0x1p53) || value != std::floor(value))
      refuse(fmt::format("'{}' is not a count", excerpt(fields[i])));
    *into[i] = static_cast<GlobalIndex>(value);
  }
  if (counts.dimensions != 2)
    refuse(fmt::format("the vertices have {} dimensions, and points have 2", counts.dimensions));
  if (counts.attributes > most_attributes || counts.markers > 1)
    refuse(
        fmt::format("{} attributes and {} boundary markers are too many", counts.attributes, counts.markers));
  return counts;
}

} // namespace

LineLayout line_layout(const PointFile &file) {
  LineLayout layout;
  layout.separator = file.separator;
  layout.named = file.named;
  layout.fields.assign(static_cast<std::size_t>(file.fields), FieldRole::attribute);
  if (file.format == PointFormat::node)
    layout.fields.front() = FieldRole::number;
  for (std::size_t i = 0; i < file.columns.size(); ++i)
    if (i < 2 || file.columns[i].name == "z")
      layout.fields[static_cast<std::size_t>(file.columns[i].place)] = i == 0   ? FieldRole::x
                                                                       : i == 1 ? FieldRole::y
                                                                                : FieldRole::z;
  return layout;
}

PointFile read_text_header(const InputFile &file) {
  DataLines lines(file);
  PointFile result = text_file(file, PointFormat::text, lines.first_byte());
  std::optional<Line> line = lines.next();
  std::optional<Line> names;
  if (line && is_line_of_names(*line)) {
    result.first_byte = line->end;
    names = std::exchange(line, lines.next());
  }
  result.named = names.has_value();
  if (!line && !names)
    return result; // no points
  const Line &first = names ? *names : *line;
  result.separator = separator_of((line ? *line : *names).text);
  const std::vector<std::string> header =
      names ? names_of(*names, result.separator) : std::vector<std::string>();
  if (names)
    result.fields = static_cast<int>(header.size());
  else {
    const auto fields = split(without_comment(line->text), result.separator);
    result.fields = static_cast<int>(fields.size()) - (fields.back().empty() ? 1 : 0);
  }
  if (result.fields < 2)
    refuse_text(file, first.offset, "the line has one column, and points need x and y",
                "separate x and y by blanks, commas or semicolons; # begins a comment");
  for (std::size_t field = 0; field < header.size(); ++field)
    if (!is_printable(header[field]))
      refuse_text(file, first.offset,
                  fmt::format("the name of column {}, '{}', is not UTF-8, or has control characters",
                              field + 1, excerpt(header[field])),
                  "write it in letters of UTF-8, for instance with iconv -f ISO-8859-1 -t UTF-8");
  result.columns = columns_of(header, result.fields);
  if (!line)
    return result;
  try {
    std::vector<double> ignored;
    parse_lines(line->text, line_layout(result), ignored);
  } catch (const LineFault &fault) {
    refuse_text(file, line->offset + static_cast<std::int64_t>(fault.offset), fault.what, fault.remedy);
  }
  result.record_bytes = lines.mean_line_bytes(line->offset);
  return result;
}

PointFile read_node_header(const InputFile &file) {
  DataLines lines(file);
  const std::optional<Line> line = lines.next();
  if (!line)
    file.refuse(0, file.bytes() == 0 ? "the file is empty" : "the file has nothing but comments",
                "begin it with the number of vertices, 2, the number of attributes, 0 or 1 boundary markers");
  const NodeCounts counts = node_counts(file, *line);
  PointFile result = text_file(file, PointFormat::node, line->end);
  result.records = counts.vertices;
  result.fields = static_cast<int>(3 + counts.attributes + counts.markers);
  result.columns = {{"x", NumberType::float64, 1}, {"y", NumberType::float64, 2}};
  for (GlobalIndex a = 0; a < counts.attributes; ++a)
    result.columns.push_back({fmt::format("attribute {}", a + 1), NumberType::float64, 3 + a});
  if (counts.markers > 0)
    result.columns.push_back({"marker", NumberType::float64, result.fields - 1});
  result.record_bytes = std::max<std::int64_t>(1, (file.bytes() - result.first_byte) /
                                                      std::max<GlobalIndex>(1, counts.vertices));
  return result;
}

} // namespace dovetail
