/// Which columns of a file are coordinates, and what the others are called.
#pragma once

#include "dovetail/io/points.hpp"

#include <string_view>
#include <vector>

namespace dovetail {

/// Local. Where the column is whose name is this in small letters; columns.size() if there is none.
std::size_t column_named(const std::vector<PointColumn> &columns, std::string_view name);

/// Local. The columns of a file in its order, with their names or without ("" for all): x and y first, then
/// the others, with names that can be those of attributes (io/text.hpp has the rules). At least two.
std::vector<PointColumn> coordinates_first(std::vector<PointColumn> columns);

} // namespace dovetail
