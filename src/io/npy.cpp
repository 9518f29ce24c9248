#include "dovetail/io/npy.hpp"

#include "point_columns.hpp"

#include "dovetail/base/excerpt.hpp"
#include "dovetail/io/little_endian.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace dovetail {
namespace {

constexpr std::string_view magic("\x93NUMPY", 6);
constexpr std::int64_t longest_header = 1 << 24;

struct Field {
  std::string name, type;
};

// What the dictionary of a header says.
struct ArrayHeader {
  std::string type;          // of all numbers, unless there are fields
  std::vector<Field> fields; // of one record
  bool fortran_order = false;
  std::vector<GlobalIndex> shape;
};

// Reads a Python dictionary with exactly the keys descr, fortran_order and shape, each once, and nothing
// after it but blanks. Throws a description of the fault.
class HeaderParser {
public:
  struct Fault {
    std::size_t position;
    std::string what;
  };

  explicit HeaderParser(std::string_view text) : text_(text) {}

  ArrayHeader parse() {
    ArrayHeader header;
    bool type = false, order = false, shape = false;
    expect('{');
    while (!accept('}')) {
      const std::string key = string();
      expect(':');
      if (key == "descr" && !type) {
        if (next() == '[')
          header.fields = fields();
        else
          header.type = string();
        type = true;
      } else if (key == "fortran_order" && !order) {
        header.fortran_order = boolean();
        order = true;
      } else if (key == "shape" && !shape) {
        header.shape = tuple();
        shape = true;
      } else {
        fail(fmt::format("key '{}' is unknown or given twice", excerpt(key)));
      }
      if (!accept(',') && next() != '}')
        fail("',' or '}' is missing");
    }
    next();
    if (position_ < text_.size())
      fail("something follows the dictionary");
    if (!type || !order || !shape)
      fail("'descr', 'fortran_order' or 'shape' is missing");
    return header;
  }

private:
  [[noreturn]] void fail(std::string what) const { throw Fault{position_, std::move(what)}; }

  // The next character that is not blank; NUL at the end.
  char next() {
    while (position_ < text_.size() && (text_[position_] == ' ' || text_[position_] == '\n'))
      ++position_;
    return position_ < text_.size() ? text_[position_] : '\0';
  }
  bool accept(char wanted) {
    if (next() != wanted)
      return false;
    ++position_;
    return true;
  }
  void expect(char wanted) {
    if (!accept(wanted))
      fail(std::string(1, wanted) + " is missing");
  }
  std::string string() {
    const char quote = next();
    if (quote != '\'' && quote != '"')
      fail("a string is missing");
    const std::size_t begin = ++position_;
    const std::size_t end = text_.find(quote, begin);
    const std::string_view inside = text_.substr(begin, end - begin);
    if (end == std::string_view::npos || inside.find_first_of("\\\n") != std::string_view::npos)
      fail("a string does not end");
    position_ = end + 1;
    return std::string(inside);
  }
  std::vector<Field> fields() {
    std::vector<Field> result;
    expect('[');
    while (!accept(']')) {
      expect('(');
      Field field;
      field.name = string();
      expect(',');
      field.type = string();
      if (accept(',') && next() != ')')
        fail(fmt::format("the field '{}' has more than one number", excerpt(field.name)));
      expect(')');
      result.push_back(std::move(field));
      if (!accept(',') && next() != ']')
        fail("',' or ']' is missing");
    }
    if (result.empty())
      fail("the records have no fields");
    return result;
  }
  bool boolean() {
    next();
    for (const std::string_view word : {"True", "False"})
      if (text_.substr(position_).starts_with(word)) {
        position_ += word.size();
        return word == "True";
      }
    fail("True or False is missing");
  }
  std::vector<GlobalIndex> tuple() {
    std::vector<GlobalIndex> numbers;
    expect('(');
    while (!accept(')')) {
      numbers.push_back(number());
      if (!accept(',') && next() != ')')
        fail("',' or ')' is missing");
    }
    return numbers;
  }
  GlobalIndex number() {
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    if (!is_digit(next()))
      fail("a number is missing");
    GlobalIndex value = 0;
    for (; position_ < text_.size() && is_digit(text_[position_]); ++position_) {
      if (value > (std::numeric_limits<GlobalIndex>::max() - 9) / 10)
        fail("a number is too large");
      value = 10 * value + (text_[position_] - '0');
    }
    if (position_ < text_.size() && text_[position_] == 'L') // long integers of Python 2
      ++position_;
    return value;
  }

  std::string_view text_;
  std::size_t position_ = 0;
};

std::string shape_text(const std::vector<GlobalIndex> &shape) {
  std::string text;
  for (const GlobalIndex extent : shape)
    text += (text.empty() ? "" : ", ") + std::to_string(extent);
  return "(" + text + (shape.size() == 1 ? ",)" : ")");
}

std::optional<NumberType> number_type(std::string_view type) {
  constexpr std::array<std::pair<std::string_view, NumberType>, 9> known{{{"<f8", NumberType::float64},
                                                                          {"<f4", NumberType::float32},
                                                                          {"|i1", NumberType::int8},
                                                                          {"|u1", NumberType::uint8},
                                                                          {"|b1", NumberType::uint8},
                                                                          {"<i2", NumberType::int16},
                                                                          {"<u2", NumberType::uint16},
                                                                          {"<i4", NumberType::int32},
                                                                          {"<u4", NumberType::uint32}}};
  for (const auto &[name, number] : known)
    if (name == type)
      return number;
  return std::nullopt;
}

// An array of rows.
void take_rows(PointFile &result, const InputFile &file, const ArrayHeader &header) {
  const std::optional<NumberType> type = number_type(header.type);
  if (type != NumberType::float64 && type != NumberType::float32)
    file.refuse(0,
                fmt::format("the numbers are of type '{}', and only '<f8' and '<f4' can be read",
                            excerpt(header.type)),
                "save it again with numpy.save(file, array.astype('<f8'))");
  constexpr GlobalIndex most_columns = 1 << 16;
  const std::vector<GlobalIndex> &shape = header.shape;
  if (shape.size() != 2 || shape[1] < 2 || shape[1] > most_columns)
    file.refuse(0,
                fmt::format("the array has the shape {}, and points need (N, 2), (N, 3) or more columns",
                            excerpt(shape_text(shape))),
                shape.size() == 2 && (shape[0] == 2 || shape[0] == 3)
                    ? "save it again with numpy.save(file, array.T)"
                    : "save x and y, and z if there is one, as columns");
  result.records = shape[0];
  for (GlobalIndex column = 0; column < shape[1]; ++column)
    result.columns.push_back({"", *type, column * bytes_of(*type)});
  result.record_bytes = shape[1] * bytes_of(*type);
  result.by_columns = header.fortran_order;
}

// Bytes that nobody uses, "|V4": NumPy's way to say that fields are aligned. 0 if it is something else.
std::int64_t padding_bytes(const Field &field) {
  std::int64_t bytes = 0;
  const char *const end = field.type.data() + field.type.size();
  const bool is_padding = field.name.empty() && field.type.starts_with("|V") &&
                          std::from_chars(field.type.data() + 2, end, bytes).ptr == end;
  return is_padding && bytes > 0 && bytes <= longest_header ? bytes : 0;
}

// Versions 1.0 and 2.0 are in Latin-1: every byte is a character of that number.
std::string utf8_of_latin1(std::string_view text) {
  std::string result;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code >= 0x80)
      result += static_cast<char>(0xc0 | code >> 6);
    result += code < 0x80 ? c : static_cast<char>(0x80 | (code & 0x3f));
  }
  return result;
}

// An array of records with named fields.
void take_fields(PointFile &result, const InputFile &file, const ArrayHeader &header) {
  if (header.shape.size() != 1)
    file.refuse(
        0,
        fmt::format("the array has the shape {}, and records need (N,)", excerpt(shape_text(header.shape))),
        "save it again with numpy.save(file, array.ravel())");
  result.records = header.shape[0];
  result.has_fields = true;
  for (const Field &field : header.fields) {
    if (const std::int64_t padding = padding_bytes(field); padding > 0) {
      result.record_bytes += padding;
      continue;
    }
    const std::optional<NumberType> type = number_type(field.type);
    if (!type)
      file.refuse(0,
                  fmt::format("the field '{}' is of type '{}', which cannot be carried", excerpt(field.name),
                              excerpt(field.type)),
                  "make it '<f8', or leave it out");
    if (!is_printable(field.name))
      file.refuse(0,
                  fmt::format("the name of the field '{}' is not UTF-8, or has control characters",
                              excerpt(field.name)),
                  "rename the field with numpy.lib.recfunctions.rename_fields");
    result.columns.push_back({field.name, *type, result.record_bytes});
    result.record_bytes += bytes_of(*type);
  }
  const std::size_t count = result.columns.size();
  if (column_named(result.columns, "x") == count || column_named(result.columns, "y") == count)
    file.refuse(0, "the records have no fields x and y", "name the fields of the coordinates x and y");
}

void check_length(const PointFile &result, const InputFile &file) {
  const std::int64_t room = file.bytes() - result.first_byte;
  if (result.records <= room / result.record_bytes && result.records * result.record_bytes == room)
    return;
  if (result.records > room / result.record_bytes)
    file.refuse(file.bytes(),
                fmt::format("the file ends here, with {} of the {} points that its header promises",
                            room / result.record_bytes, result.records),
                "copy or save the file again");
  file.refuse(result.first_byte + result.records * result.record_bytes,
              fmt::format("the file goes on after the {} points that its header promises", result.records),
              "save one array to a file, again");
}

} // namespace

PointFile read_npy_header(const InputFile &file) {
  const auto refuse_header = [&file](std::int64_t byte, const std::string &what) {
    file.refuse(byte, "the NPY header is malformed: " + what, "save the file again with numpy.save");
  };
  std::vector<std::byte> bytes(static_cast<std::size_t>(std::min<std::int64_t>(file.bytes(), 12)));
  file.read_at(0, bytes);
  const std::string_view start(reinterpret_cast<const char *>(bytes.data()), bytes.size());
  if (!start.starts_with(magic))
    file.refuse(0, bytes.empty() ? "the file is empty" : "this is not an NPY file",
                "save the points with numpy.save");
  const int major = bytes.size() > 6 ? std::to_integer<int>(bytes[6]) : 0;
  const std::int64_t prefix = major == 1 ? 10 : 12;
  if (file.bytes() < prefix)
    refuse_header(file.bytes(), "the file ends inside it");
  if (major < 1 || major > 3 || std::to_integer<int>(bytes[7]) != 0)
    file.refuse(6, fmt::format("NPY version {}.{} is not known", major, std::to_integer<int>(bytes[7])),
                "save the file again with numpy.save");
  const std::int64_t length = major == 1 ? std::int64_t{load_little<std::uint16_t>(&bytes[8])}
                                         : std::int64_t{load_little<std::uint32_t>(&bytes[8])};
  if (length > longest_header)
    refuse_header(8, fmt::format("it has {} bytes", length));
  if (length > file.bytes() - prefix)
    refuse_header(file.bytes(), "the file ends inside it");
  bytes.resize(static_cast<std::size_t>(length));
  file.read_at(prefix, bytes);

  PointFile result;
  result.path = file.path();
  result.format = PointFormat::npy;
  result.file_bytes = file.bytes();
  result.first_byte = prefix + length;
  try {
    ArrayHeader header = HeaderParser({reinterpret_cast<const char *>(bytes.data()), bytes.size()}).parse();
    if (major < 3)
      for (Field &field : header.fields)
        field.name = utf8_of_latin1(field.name);
    if (header.fields.empty())
      take_rows(result, file, header);
    else
      take_fields(result, file, header);
    result.columns = coordinates_first(std::move(result.columns));
  } catch (const HeaderParser::Fault &fault) {
    refuse_header(prefix + static_cast<std::int64_t>(fault.position), fault.what);
  }
  check_length(result, file);
  return result;
}

namespace {

std::string header_with(std::string dictionary) {
  constexpr std::size_t multiple = 64;
  // Version 1.0 says its length in two bytes, 2.0 in four; 3.0 is the one in UTF-8.
  const bool is_ascii = std::none_of(dictionary.begin(), dictionary.end(),
                                     [](char c) { return static_cast<unsigned char>(c) >= 0x80; });
  const bool is_short = is_ascii && dictionary.size() <= 0xffff - multiple;
  const std::size_t prefix = is_short ? 10 : 12;
  const std::size_t used = prefix + dictionary.size() + 1;
  dictionary.append((multiple - used % multiple) % multiple, ' ');
  dictionary += '\n';
  std::string header(magic);
  header += !is_ascii ? '\x03' : is_short ? '\x01' : '\x02';
  header += '\0';
  for (std::size_t byte = 8; byte < prefix; ++byte)
    header += static_cast<char>((dictionary.size() >> (8 * (byte - 8))) & 0xff);
  return header + dictionary;
}

} // namespace

std::string npy_array_header(const std::string &type, const std::string &shape) {
  return header_with(fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}", type, shape));
}

std::string npy_header(GlobalIndex rows, int columns) {
  return npy_array_header("<f8", fmt::format("({}, {})", rows, columns));
}

std::string npy_records_header(GlobalIndex rows, const std::vector<std::string> &names) {
  std::string fields;
  for (std::string name : names) {
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == '\'' || c == '\\' || c == '\n'; }, '_');
    fields += fmt::format("{}('{}', '<f8')", fields.empty() ? "" : ", ", name);
  }
  return header_with(
      fmt::format("{{'descr': [{}], 'fortran_order': False, 'shape': ({},), }}", fields, rows));
}

} // namespace dovetail
