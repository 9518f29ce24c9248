// Triangle's .poly and .node files, one line after the other.
#include "dovetail/base/excerpt.hpp"
#include "dovetail/io/domain.hpp"
#include "dovetail/io/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

namespace dovetail {
namespace {

constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
constexpr std::string_view blanks = " \t\r";

/// The lines of a text that have data, divided into words.
class WordLines {
public:
  explicit WordLines(const InputFile &file) : file_(file) {
    text_.resize(static_cast<std::size_t>(file.bytes()));
    file.read_at(0, std::as_writable_bytes(std::span(text_)));
    if (const std::size_t nul = text_.find('\0'); nul != std::string::npos)
      file.refuse(static_cast<std::int64_t>(nul), "the file is not text: a byte is zero",
                  "check what the file is; text must be ASCII or UTF-8");
    text_ += '\n'; // which ends the last number
    if (std::string_view(text_).starts_with(byte_order_mark))
      next_ = byte_order_mark.size();
  }

  /// False at the end.
  bool next() {
    while (next_ < text_.size()) {
      begin_ = next_;
      const std::size_t end = text_.find('\n', begin_);
      next_ = end + 1;
      ++line_;
      split(std::string_view(text_).substr(begin_, end - begin_));
      if (!words_.empty())
        return true;
    }
    words_.clear();
    return false;
  }

  std::size_t count() const { return words_.size(); }
  std::int64_t line() const { return line_; }
  /// Bytes that are still to come: no more lines than these.
  std::size_t rest() const { return text_.size() - next_; }

  double number(std::size_t word) const {
    const std::string_view text = words_[word];
    double value = 0;
    if (parse_decimal(text.data(), value) != text.data() + text.size())
      refuse_word(word, fmt::format("'{}' is not a number", excerpt(text)),
                  "write numbers in decimal, with a point, separated by blanks");
    return value;
  }
  double coordinate(std::size_t word) const {
    const double value = number(word);
    if (!std::isfinite(value))
      refuse_word(word, fmt::format("'{}' is not a finite number", excerpt(words_[word])),
                  "give every point finite coordinates");
    return value + 0.0; // not -0.0
  }
  std::int64_t integer(std::size_t word, std::int64_t low, std::int64_t high, const char *what) const {
    const double value = number(word);
    if (!(value >= static_cast<double>(low) && value <= static_cast<double>(high)) ||
        value != std::floor(value))
      refuse_word(word, fmt::format("'{}' is not {}", excerpt(words_[word]), what),
                  fmt::format("write a whole number from {} to {}", low, high));
    return static_cast<std::int64_t>(value);
  }
  std::int32_t marker(std::size_t word) const {
    return static_cast<std::int32_t>(integer(word, std::numeric_limits<std::int32_t>::min(),
                                             std::numeric_limits<std::int32_t>::max(), "a marker"));
  }

  /// A word that the line has not, and so counts as 0, is where the line is.
  [[noreturn]] void refuse_word(std::size_t word, const std::string &what, const std::string &remedy) const {
    if (word >= words_.size())
      refuse_line(what, remedy);
    refuse_text(file_, words_[word].data() - text_.data(), what, remedy);
  }
  [[noreturn]] void refuse_line(const std::string &what, const std::string &remedy) const {
    refuse_text(file_, static_cast<std::int64_t>(begin_), what, remedy);
  }
  /// After next() was false.
  [[noreturn]] void refuse_end(const std::string &what, const std::string &remedy) const {
    refuse_text(file_, file_.bytes(), "the file ends " + what, remedy);
  }

private:
  void split(std::string_view line) {
    line = line.substr(0, std::min(line.find('#'), line.find("//")));
    words_.clear();
    for (std::size_t first = 0; (first = line.find_first_not_of(blanks, first)) != std::string_view::npos;) {
      const std::size_t end = std::min(line.size(), line.find_first_of(blanks, first));
      words_.push_back(line.substr(first, end - first));
      first = end;
    }
  }

  const InputFile &file_;
  std::string text_;
  std::size_t next_ = 0, begin_ = 0;
  std::int64_t line_ = 0;
  std::vector<std::string_view> words_;
};

constexpr std::int64_t most = std::numeric_limits<LocalIndex>::max();

/// Numbers of the header of a part: the first one counts its lines.
std::vector<std::int64_t> header_of(const WordLines &lines, std::size_t longest, const char *layout) {
  if (lines.count() > longest)
    lines.refuse_line(
        fmt::format("the line has {} columns, and this part begins with up to {}", lines.count(), longest),
        fmt::format("begin it with: {}", layout));
  std::vector<std::int64_t> numbers;
  for (std::size_t i = 0; i < lines.count(); ++i)
    numbers.push_back(lines.integer(i, 0, most, "a count"));
  numbers.resize(longest, 0);
  return numbers;
}

/// The next line of a part, which must have from `least` to `longest` columns.
void next_line(WordLines &lines, std::int64_t i, std::int64_t count, const char *what, std::size_t least,
               std::size_t longest) {
  if (!lines.next())
    lines.refuse_end(fmt::format("after {} of {} {}", i, count, what),
                     "copy or make the file again, or correct the number of lines");
  if (lines.count() < least || lines.count() > longest)
    lines.refuse_line(least == longest ? fmt::format("the line has {} columns where {} of {} must be",
                                                     lines.count(), least, what)
                                       : fmt::format("the line has {} columns where {} to {} of {} must be",
                                                     lines.count(), least, longest, what),
                      "see whether the numbers of lines, attributes and markers in the headers are right");
}

constexpr const char *vertex_header = "vertices, 2, attributes of each, 0 or 1 boundary markers";

/// The vertices below a header.
void read_vertices(WordLines &lines, const std::vector<std::int64_t> &header, DomainFile &domain) {
  const std::int64_t count = header[0], attributes = header[2], markers = header[3];
  if (header[1] != 2 && count > 0)
    lines.refuse_word(1, fmt::format("the vertices have {} dimensions, and points have 2", header[1]),
                      fmt::format("begin with: {}", vertex_header));
  if (attributes > 1 << 16 || markers > 1)
    lines.refuse_line(fmt::format("{} attributes and {} boundary markers are too many", attributes, markers),
                      fmt::format("begin with: {}", vertex_header));
  for (std::int64_t a = 0; a < attributes; ++a)
    domain.attributes.push_back({fmt::format("attribute {}", a + 1), {}});
  const auto columns = static_cast<std::size_t>(3 + attributes + markers);
  domain.set.vertices.reserve(std::min(static_cast<std::size_t>(count), lines.rest() / 6));
  for (std::int64_t i = 0; i < count; ++i) {
    next_line(lines, i, count, "vertices", columns, columns);
    if (i == 0)
      domain.first_number = static_cast<int>(lines.integer(0, 0, 1, "the first vertex, which is 0 or 1"));
    else if (lines.number(0) != static_cast<double>(domain.first_number + i))
      lines.refuse_word(0,
                        fmt::format("vertex {} stands where {} must",
                                    excerpt(fmt::to_string(lines.number(0))), domain.first_number + i),
                        "number the vertices upwards from 0 or 1, without gaps");
    domain.set.vertices.push_back({lines.coordinate(1), lines.coordinate(2)});
    for (std::size_t a = 0; a < domain.attributes.size(); ++a)
      domain.attributes[a].values.push_back(lines.number(3 + a));
    domain.set.vertex_markers.push_back(markers > 0 ? lines.marker(columns - 1) : 0);
  }
}

void read_vertices_of(const InputFile &nodes, DomainFile &domain) {
  WordLines lines(nodes);
  if (!lines.next())
    lines.refuse_end("before there is anything but comments",
                     fmt::format("begin it with: {}", vertex_header));
  read_vertices(lines, header_of(lines, 4, vertex_header), domain);
  if (lines.next())
    lines.refuse_line("the line comes after the last vertex", "correct the number of vertices");
}

void read_segments(WordLines &lines, DomainFile &domain) {
  if (!lines.next())
    lines.refuse_end("before the segments", "go on with: segments, 0 or 1 boundary markers");
  const auto header = header_of(lines, 2, "segments, 0 or 1 boundary markers");
  if (header[1] > 1)
    lines.refuse_word(1, fmt::format("{} boundary markers are too many", header[1]),
                      "begin the segments with: segments, 0 or 1 boundary markers");
  const auto columns = static_cast<std::size_t>(3 + header[1]);
  domain.set.segments.reserve(std::min(static_cast<std::size_t>(header[0]), lines.rest() / 6));
  const auto vertices = static_cast<std::int64_t>(domain.set.vertices.size());
  for (std::int64_t i = 0; i < header[0]; ++i) {
    next_line(lines, i, header[0], "segments", 3, columns);
    const auto end = [&](std::size_t word) {
      const double number = lines.number(word) - domain.first_number;
      if (!(number >= 0 && number < static_cast<double>(vertices)) || number != std::floor(number))
        lines.refuse_word(word, fmt::format("there is no vertex {}", lines.number(word)),
                          vertices == 0
                              ? "give the vertices first, in this file or in the .node file beside it"
                              : fmt::format("vertices are numbered from {} to {}", domain.first_number,
                                            domain.first_number + vertices - 1));
      return static_cast<LocalIndex>(number);
    };
    lines.number(0);
    domain.set.segments.push_back({end(1), end(2), lines.count() > 3 ? lines.marker(3) : 0});
    domain.segment_lines.push_back(lines.line());
  }
}

/// Holes and regions; the file may end before either.
void read_seeds(WordLines &lines, DomainFile &domain) {
  if (!lines.next())
    return;
  const std::int64_t holes = header_of(lines, 1, "holes").front();
  for (std::int64_t i = 0; i < holes; ++i) {
    next_line(lines, i, holes, "holes", 3, 3);
    lines.number(0);
    domain.set.holes.push_back({lines.coordinate(1), lines.coordinate(2)});
  }
  if (!lines.next())
    return;
  const std::int64_t regions = header_of(lines, 1, "regions").front();
  for (std::int64_t i = 0; i < regions; ++i) {
    next_line(lines, i, regions, "regions", 4, 5);
    lines.number(0);
    const double area = lines.count() > 4 ? lines.coordinate(4) : 0;
    domain.set.regions.push_back(
        {{lines.coordinate(1), lines.coordinate(2)}, lines.coordinate(3), std::max(0.0, area)});
  }
  if (lines.next())
    lines.refuse_line("the line comes after the last region", "correct the number of regions");
}

} // namespace

DomainFile read_poly(const InputFile &file, const InputFile *nodes) {
  DomainFile domain;
  domain.path = file.path();
  WordLines lines(file);
  if (!lines.next())
    lines.refuse_end("before there is anything but comments",
                     fmt::format("begin it with: {}", vertex_header));
  const auto header = header_of(lines, 4, vertex_header);
  if (header[0] > 0) {
    read_vertices(lines, header, domain);
  } else if (nodes != nullptr) {
    read_vertices_of(*nodes, domain);
  } else {
    const std::string beside = file.path().substr(0, file.path().rfind('.')) + ".node";
    read_vertices_of(InputFile(beside), domain);
  }
  read_segments(lines, domain);
  read_seeds(lines, domain);
  return domain;
}

} // namespace dovetail
