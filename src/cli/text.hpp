/// Numbers as people read and write them. Local.
#pragma once

#include "dovetail/base/types.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dovetail::cli {

/// 1234567 as "1,234,567".
std::string with_separators(std::int64_t number);

/// A duration as "0.123 s", "12.3 s", "4 min 05 s" or "2 h 03 min".
std::string duration_text(double seconds);

/// The same for estimates: "12 s", "4 min 05 s" or "2 h 03 min".
std::string rough_duration_text(double seconds);

/// A size as "512 bytes", "1.5 MiB" or "3.25 GiB".
std::string size_text(std::int64_t bytes);

/// "1 triangle", "2 triangles".
std::string counted(std::int64_t number, std::string_view singular, std::string_view plural);

/// Prints a line of a list of facts on standard output: name, then value, in two columns.
void print_row(std::string_view name, std::string_view value);

/// {"a", "b"} as "a, b" if the separator is ", ".
template <class Texts> std::string joined(const Texts &texts, std::string_view separator) {
  std::string line;
  for (const auto &text : texts) {
    if (!line.empty())
      line += separator;
    line += text;
  }
  return line;
}

/// The extension of a file's name in small letters, with its dot: ".las" of "dir/A.LAS".
std::string extension_of(const std::string &path);

/// A count as people type it: "1000000", "1e6", "2.5e6" or "1,000,000". Throws std::invalid_argument with a
/// reason unless it is a whole number from 0 to 2^53.
GlobalIndex count_from_text(const std::string &text);

/// Throws std::invalid_argument with a reason unless it is a whole number from 0 to 2^64 - 1 in digits.
std::uint64_t seed_from_text(const std::string &text);

/// "2,9" as {2, 9}. Throws std::invalid_argument with a reason unless each is a whole number from 0 to 255.
std::vector<int> classes_from_text(const std::string &text);

} // namespace dovetail::cli
