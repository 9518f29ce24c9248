/// Points that a program has in memory, made fit to be triangulated.
#pragma once

#include "dovetail/base/point_table.hpp"
#include "dovetail/comm/communicator.hpp"

#include <span>
#include <string>

namespace dovetail {

/// Collective. A table of this rank's points, numbered in the order of the ranks: the first rank's from 0,
/// then the second's, and so on. Checks nothing. O(n).
PointTable number_points(const Communicator &comm, std::span<const Point> points);

/// Collective. Makes every -0.0 of the coordinates 0.0, and sees to it that the table can be triangulated.
/// Errors, on all ranks alike: a coordinate, or a z, that is infinite or not a number (input); columns of
/// different lengths, or other attributes than on the first rank (usage). `subject` is how they name the
/// points. That input indices are distinct is not checked. O(n), one pass.
void check_points(const Communicator &comm, PointTable &table, const std::string &subject = "input");

} // namespace dovetail
