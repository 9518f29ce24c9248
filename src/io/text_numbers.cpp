// Decimal numbers, and lines of them.
#include "dovetail/io/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <system_error>

namespace dovetail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// All powers of ten that are doubles.
constexpr std::array<double, 23> powers_of_ten = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                  1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                  1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
constexpr std::int64_t largest_exact_power = 22;
constexpr std::uint64_t largest_exact_integer = std::uint64_t{1} << 53;
constexpr std::int64_t digits_of_64_bits = 19; // so many always fit
constexpr std::int64_t huge_exponent = std::int64_t{1} << 40;

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_blank(char c) { return c == ' ' || c == '\t'; }

const char *take_digits(const char *p, std::uint64_t &number) {
  for (; is_digit(*p); ++p)
    number = 10 * number + static_cast<std::uint64_t>(*p - '0');
  return p;
}

// "e+12" and the like, if it is one.
const char *take_exponent(const char *p, std::int64_t &exponent) {
  const char *digits = p + 1;
  const bool negative = *digits == '-';
  if (negative || *digits == '+')
    ++digits;
  if (!is_digit(*digits))
    return p;
  std::int64_t value = 0;
  for (; is_digit(*digits); ++digits)
    value = std::min(10 * value + (*digits - '0'), huge_exponent);
  exponent += negative ? -value : value;
  return digits;
}

// nan, inf and infinity in any case.
const char *take_word(const char *p, double &value) {
  const auto matches = [p](std::string_view word) {
    for (std::size_t i = 0; i < word.size(); ++i)
      if ((p[i] | 0x20) != word[i]) // the newline that ends the text differs from every letter
        return false;
    return true;
  };
  for (const std::string_view word : {"infinity", "inf", "nan"})
    if (matches(word)) {
      value = word == "nan" ? std::numeric_limits<double>::quiet_NaN() : infinity;
      return p + word.size();
    }
  return nullptr;
}

// Of digits that from_chars found to be out of range: the exponent of the first that is not zero tells.
double overflow_or_underflow(const char *digits, const char *end, std::int64_t exponent) {
  bool leading = true;
  std::int64_t significant = 0;
  for (const char *p = digits; p < end && (is_digit(*p) || *p == '.'); ++p) {
    leading = leading && (*p == '0' || *p == '.');
    significant += !leading && *p != '.' ? 1 : 0;
  }
  return significant + exponent > 0 ? infinity : 0.0;
}

} // namespace

// What has at most 53 bits, times or divided by a power of ten that is a double, takes one rounding (Clinger,
// How to read floating point numbers accurately, PLDI 1990). The rest is for from_chars.
const char *parse_decimal(const char *text, double &value) {
  const bool negative = *text == '-';
  const char *const digits = negative || *text == '+' ? text + 1 : text;
  std::uint64_t mantissa = 0;
  const char *p = take_digits(digits, mantissa);
  std::int64_t count = p - digits, exponent = 0;
  if (*p == '.') {
    const char *const fraction = p + 1;
    p = take_digits(fraction, mantissa);
    exponent = fraction - p;
    count -= exponent;
  }
  if (count == 0)
    p = take_word(digits, value);
  else {
    if ((*p | 0x20) == 'e')
      p = take_exponent(p, exponent);
    if (count <= digits_of_64_bits && mantissa <= largest_exact_integer &&
        std::abs(exponent) <= largest_exact_power) {
      const auto whole = static_cast<double>(mantissa);
      value = exponent < 0 ? whole / powers_of_ten[static_cast<std::size_t>(-exponent)]
                           : whole * powers_of_ten[static_cast<std::size_t>(exponent)];
    } else if (std::from_chars(digits, p, value).ec != std::errc{})
      value = overflow_or_underflow(digits, p, exponent);
  }
  if (negative)
    value = -value;
  return p;
}

namespace {

const char *skip_blanks(const char *p) {
  while (is_blank(*p))
    ++p;
  return p;
}

bool ends_line(const char *p) {
  return *p == '\n' || (*p == '\r' && p[1] == '\n') || *p == '#' || (*p == '/' && p[1] == '/');
}

const char *after_line(const char *p, const char *end) {
  return static_cast<const char *>(std::memchr(p, '\n', static_cast<std::size_t>(end - p))) + 1;
}

// Thrown inside this file: `at` becomes the offset.
struct Fault {
  const char *at;
  std::string what, remedy;
};

constexpr const char *repair = "remove or repair that line";
constexpr const char *same_everywhere =
    "separate the numbers of all lines in the same way, and write decimal points; # begins a comment";

std::string name_of(const LineLayout &layout, std::size_t field) {
  switch (layout.fields[field]) {
  case FieldRole::x:
    return "x";
  case FieldRole::y:
    return "y";
  case FieldRole::z:
    return "z";
  case FieldRole::number:
    return "the vertex number";
  case FieldRole::attribute:
    break;
  }
  return fmt::format("column {}", field + 1);
}

// The field that begins at `begin`, for a message.
std::string quoted(const char *begin, char separator) {
  constexpr std::ptrdiff_t longest = 40;
  const char *end = begin;
  while (*end != separator && !ends_line(end) && !(separator == ' ' && is_blank(*end)) &&
         end - begin < longest)
    ++end;
  std::string text(begin, end);
  text.erase(std::find_if(text.rbegin(), text.rend(), [](char c) { return !is_blank(c); }).base(),
             text.end());
  for (char &c : text)
    if (static_cast<unsigned char>(c) < ' ')
      c = c == '\t' ? ' ' : '?';
  return "'" + text + (end - begin == longest ? "..." : "") + "'";
}

[[noreturn]] void refuse_field(const char *at, const LineLayout &layout, std::size_t field) {
  const std::string text = quoted(at, layout.separator);
  const bool decimal_comma = layout.separator != ',' && text.find(',') != std::string::npos &&
                             text.find_first_not_of("0123456789.,+-eE'") == std::string::npos;
  const bool in_quotes = text.find('"') != std::string::npos;
  const bool further = layout.fields[field] == FieldRole::attribute && layout.separator != ' ';
  throw Fault{at, fmt::format("{} is {}, which is not a number", name_of(layout, field), text),
              decimal_comma ? "write decimal points instead of decimal commas, for instance with tr , ."
              : in_quotes   ? "write numbers without quotes, for instance with tr -d '\"'"
              : further     ? "leave columns out that are not all numbers, for instance with cut"
                            : same_everywhere};
}

[[noreturn]] void refuse_count(const char *at, const LineLayout &layout, const char *fault) {
  throw Fault{at,
              fmt::format("the line has {} columns: {} {}", fault,
                          layout.named ? "the line of names has" : "the lines before have",
                          layout.fields.size()),
              same_everywhere};
}

[[noreturn]] void refuse_value(const char *at, double value, const LineLayout &layout, std::size_t field) {
  const bool digits = is_digit(*at) || is_digit(at[1]) || *at == '.' || at[1] == '.';
  throw Fault{at,
              fmt::format("{} is {}", name_of(layout, field),
                          std::isnan(value) ? "NaN (not a number)"
                          : digits          ? quoted(at, layout.separator) + ", too large for a double"
                                            : "infinite"),
              repair};
}

// One field into `value`; returns the end of its number.
const char *parse_field(const char *p, const LineLayout &layout, std::size_t field, double &value) {
  const char *end = parse_decimal(p, value);
  if (end == nullptr) {
    if (layout.separator == ' ' || (*p != layout.separator && !ends_line(p)))
      refuse_field(p, layout, field);
    if (layout.fields[field] != FieldRole::attribute)
      throw Fault{p, fmt::format("{} is missing", name_of(layout, field)), repair};
    value = std::numeric_limits<double>::quiet_NaN();
    end = p;
  }
  if (!std::isfinite(value) && layout.fields[field] != FieldRole::attribute)
    refuse_value(p, value, layout, field);
  return end;
}

// A line of data from its first field on; returns where its numbers end.
const char *parse_line(const char *p, const LineLayout &layout, double *row) {
  const std::size_t count = layout.fields.size();
  const bool by_blanks = layout.separator == ' ';
  for (std::size_t field = 0; field < count; ++field) {
    const char *const begin = p;
    const char *const end = parse_field(begin, layout, field, row[field]);
    p = skip_blanks(end);
    if (ends_line(p)) {
      if (field + 1 < count)
        refuse_count(p, layout, "too few");
      return p;
    }
    if (by_blanks ? p == end : *p != layout.separator)
      refuse_field(begin, layout, field);
    if (!by_blanks)
      p = skip_blanks(p + 1);
  }
  if (!ends_line(p))
    refuse_count(p, layout, "too many");
  return p;
}

} // namespace

void parse_lines(std::string_view lines, const LineLayout &layout, std::vector<double> &numbers) {
  std::vector<double> row(layout.fields.size());
  const char *const end = lines.data() + lines.size();
  try {
    for (const char *p = lines.data(); p < end; p = after_line(p, end)) {
      p = skip_blanks(p);
      if (ends_line(p))
        continue;
      p = parse_line(p, layout, row.data());
      numbers.insert(numbers.end(), row.begin(), row.end());
    }
  } catch (Fault &fault) {
    throw LineFault{static_cast<std::size_t>(fault.at - lines.data()), std::move(fault.what),
                    std::move(fault.remedy)};
  }
}

GlobalIndex count_data_lines(std::string_view lines) {
  GlobalIndex count = 0;
  const char *const end = lines.data() + lines.size();
  for (const char *p = lines.data(); p < end; p = after_line(p, end)) {
    p = skip_blanks(p);
    count += ends_line(p) ? 0 : 1;
  }
  return count;
}

std::size_t offset_of_data_line(std::string_view lines, GlobalIndex record) {
  const char *const end = lines.data() + lines.size();
  const char *p = lines.data();
  for (; p < end; p = after_line(p, end)) {
    p = skip_blanks(p);
    if (!ends_line(p) && record-- == 0)
      break;
  }
  return static_cast<std::size_t>(p - lines.data());
}

} // namespace dovetail
