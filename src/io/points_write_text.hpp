/// Points as lines of text. Local.
#pragma once

#include "dovetail/base/point_table.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace dovetail {

/// What stands in a line, and how.
struct TextStyle {
  char separator = ' ';
  bool numbered = false;        ///< the line begins with the number of the point
  GlobalIndex first_number = 0; ///< of the first point of the table
  std::vector<const std::vector<double> *> attributes;
  const std::vector<double> *marker = nullptr; ///< whole numbers, last
};

/// Appends points first .. first + count - 1, each a line. Numbers are the shortest decimals that read back
/// to the same double.
void append_lines(const PointTable &table, std::size_t first, std::size_t count, const TextStyle &style,
                  std::string &text);

/// Whether all can be written as whole numbers.
bool are_whole(const std::vector<double> &values);

/// The line above the data of a .csv file.
std::string line_of_names(const PointTable &table);

} // namespace dovetail
