#include "text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <system_error>

namespace dovetail::cli {

std::string with_separators(std::int64_t number) {
  std::string text = fmt::format("{}", number);
  const std::size_t first_digit = number < 0 ? 1 : 0;
  for (std::size_t end = text.size(); end > first_digit + 3;) {
    end -= 3;
    text.insert(end, 1, ',');
  }
  return text;
}

std::string duration_text(double seconds) {
  if (seconds < 9.9995)
    return fmt::format("{:.3f} s", seconds);
  if (seconds < 99.95)
    return fmt::format("{:.1f} s", seconds);
  return rough_duration_text(seconds);
}

std::string rough_duration_text(double seconds) {
  const auto whole = static_cast<std::int64_t>(std::llround(seconds));
  if (whole < 100)
    return fmt::format("{} s", whole);
  if (whole < 3600)
    return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

std::string size_text(std::int64_t bytes) {
  constexpr double mebi = 1024.0 * 1024.0;
  const auto size = static_cast<double>(bytes);
  if (size < 1024.0)
    return counted(bytes, "byte", "bytes");
  if (size < mebi)
    return fmt::format("{:.1f} KiB", size / 1024.0);
  if (size < 1024.0 * mebi)
    return fmt::format("{:.1f} MiB", size / mebi);
  return fmt::format("{:.2f} GiB", size / (1024.0 * mebi));
}

void print_row(std::string_view name, std::string_view value) { fmt::print("{:<18} {}\n", name, value); }

std::string counted(std::int64_t number, std::string_view singular, std::string_view plural) {
  return fmt::format("{} {}", with_separators(number), number == 1 ? singular : plural);
}

std::string extension_of(const std::string &path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

GlobalIndex count_from_text(const std::string &text) {
  std::string plain;
  for (const char c : text)
    if (c != ',' && c != '_' && c != '\'')
      plain += c;
  // strtod alone would also take blanks, "nan", "inf" and hexadecimal numbers.
  if (plain.empty() || plain.find_first_not_of("0123456789.eE+") != std::string::npos)
    throw std::invalid_argument(fmt::format("'{}' is not a number of points, such as 1000000 or 1e6", text));
  char *end = nullptr;
  const double value = std::strtod(plain.c_str(), &end);
  if (*end != '\0')
    throw std::invalid_argument(fmt::format("'{}' is not a number of points, such as 1000000 or 1e6", text));
  constexpr double largest = 9007199254740992.0; // 2^53: every whole number up to it is a double
  if (!(value <= largest))
    throw std::invalid_argument(fmt::format("'{}' is more points than can be numbered", text));
  if (value != std::floor(value))
    throw std::invalid_argument(fmt::format("'{}' is not a whole number", text));
  return static_cast<GlobalIndex>(value);
}

std::uint64_t seed_from_text(const std::string &text) {
  std::uint64_t seed = 0;
  const char *const end = text.data() + text.size();
  const auto [stop, fault] = std::from_chars(text.data(), end, seed);
  if (fault != std::errc() || stop != end)
    throw std::invalid_argument(fmt::format("'{}' is not a whole number from 0 to 2^64 - 1", text));
  return seed;
}

std::vector<int> classes_from_text(const std::string &text) {
  std::vector<int> classes;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    const std::string part = text.substr(begin, comma - begin);
    const bool digits =
        !part.empty() && part.size() <= 3 && part.find_first_not_of("0123456789") == std::string::npos;
    const int value = digits ? std::stoi(part) : -1;
    if (value < 0 || value > 255)
      throw std::invalid_argument(
          fmt::format("'{}' is not a list of classes from 0 to 255, such as 2,9", text));
    classes.push_back(value);
    begin = comma + 1;
  }
  return classes;
}

} // namespace dovetail::cli
