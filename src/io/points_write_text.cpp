#include "points_write_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>

namespace dovetail {
namespace {

constexpr std::size_t longest_number = 32; // 24 for a double, 20 for an integer

char *put(GlobalIndex value, char *at) { return std::to_chars(at, at + longest_number, value).ptr; }

// Measured coordinates mostly have a few decimals: m / 10^8 with m < 10^15, so that at most one such m rounds
// to the number, and the division, which is rounded correctly, says whether it does. Null if none does.
char *put_few_decimals(double value, char *at) {
  constexpr double scale = 1e8, limit = 1e7;
  constexpr std::uint64_t unit = 100'000'000;
  constexpr int decimals = 8;
  const double size = std::abs(value);
  if (!(size < limit) || (value == 0 && std::signbit(value)))
    return nullptr;
  // Wrongly rounded in rare cases, which the division below refuses.
  const auto scaled = static_cast<std::uint64_t>(size * scale + 0.5); // NOLINT(bugprone-incorrect-roundings)
  if (static_cast<double>(scaled) / scale != size)
    return nullptr;
  if (value < 0)
    *at++ = '-';
  at = put(static_cast<GlobalIndex>(scaled / unit), at);
  std::uint64_t fraction = scaled % unit;
  if (fraction == 0)
    return at;
  *at = '.';
  for (int digit = decimals; digit > 0; --digit, fraction /= 10)
    at[digit] = static_cast<char>('0' + fraction % 10);
  at += decimals;
  while (*at == '0')
    --at;
  return at + 1;
}

char *put(double value, char *at) {
  char *const end = put_few_decimals(value, at);
  return end != nullptr ? end : std::to_chars(at, at + longest_number, value).ptr;
}

} // namespace

void append_lines(const PointTable &table, std::size_t first, std::size_t count, const TextStyle &style,
                  std::string &text) {
  // Room for the longest lines is made for a few at a time, so that it stays in the cache.
  constexpr std::size_t at_once = 128;
  const std::size_t longest_line = (style.attributes.size() + 4) * (longest_number + 1) + 1;
  char *p = nullptr;
  const auto add = [&](auto value) {
    *p++ = style.separator;
    p = put(value, p);
  };
  for (const std::size_t end = first + count; first < end;) {
    const std::size_t before = text.size(), stop = std::min(end, first + at_once);
    text.resize(before + (stop - first) * longest_line);
    p = text.data() + before;
    for (std::size_t i = first; i < stop; ++i) {
      if (style.numbered) {
        p = put(style.first_number + static_cast<GlobalIndex>(i), p);
        *p++ = style.separator;
      }
      p = put(table.points[i].x, p);
      add(table.points[i].y);
      for (const std::vector<double> *attribute : style.attributes)
        add((*attribute)[i]);
      if (style.marker != nullptr)
        add(static_cast<GlobalIndex>((*style.marker)[i]));
      *p++ = '\n';
    }
    text.resize(static_cast<std::size_t>(p - text.data()));
    first = stop;
  }
}

bool are_whole(const std::vector<double> &values) {
  return std::all_of(values.begin(), values.end(),
                     [](double v) { return std::abs(v) <= 0x1p53 && v == std::floor(v); });
}

std::string line_of_names(const PointTable &table) {
  std::string line = "x,y";
  for (const Attribute &attribute : table.attributes) {
    std::string name = attribute.name;
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == '"' || c == '\n' || c == '\r'; }, '_');
    const bool plain = name.find_first_of(",;#/ \t") == std::string::npos;
    line += plain ? "," + name : ",\"" + name + "\"";
  }
  return line + "\n";
}

} // namespace dovetail
