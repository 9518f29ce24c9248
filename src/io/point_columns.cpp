#include "point_columns.hpp"

#include "vtkhdf.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>
#include <string>

namespace dovetail {
namespace {

std::string in_small_letters(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

} // namespace

std::size_t column_named(const std::vector<PointColumn> &columns, std::string_view name) {
  const auto found = std::find_if(columns.begin(), columns.end(), [name](const PointColumn &column) {
    return in_small_letters(column.name) == name;
  });
  return static_cast<std::size_t>(found - columns.begin());
}

std::vector<PointColumn> coordinates_first(std::vector<PointColumn> columns) {
  const bool unnamed = std::all_of(columns.begin(), columns.end(),
                                   [](const PointColumn &column) { return column.name.empty(); });
  std::size_t x = column_named(columns, "x"), y = column_named(columns, "y");
  if (x == columns.size() || y == columns.size()) {
    x = 0;
    y = 1;
  }
  std::vector<PointColumn> ordered{{"x", columns[x].type, columns[x].place},
                                   {"y", columns[y].type, columns[y].place}};
  // Names in a mesh file that are no attribute's.
  std::set<std::string, std::less<>> taken(vtkhdf::reserved_names.begin(), vtkhdf::reserved_names.end());
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (c == x || c == y)
      continue;
    std::string name((unnamed && c == 2) || columns[c].name == "Z" ? std::string_view("z") : columns[c].name);
    std::replace(name.begin(), name.end(), '/', '_');
    if (name.empty() || name == "." || taken.contains(name))
      name = fmt::format("column {}", c + 1);
    taken.insert(name);
    ordered.push_back({name, columns[c].type, columns[c].place});
  }
  std::stable_partition(ordered.begin() + 2, ordered.end(),
                        [](const PointColumn &column) { return column.name == "z"; });
  return ordered;
}

} // namespace dovetail
