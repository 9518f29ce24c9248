/// What the commands say of a mesh. Local; for the root.
#pragma once

#include "dovetail/base/types.hpp"
#include "dovetail/distributed/validate.hpp"

#include <string>

namespace dovetail::cli {

/// "x" or "y".
std::string axis_name(Axis axis);

/// Why so many sites have no triangle: a valid mesh, but one that nobody expects.
std::string no_triangles_reason(GlobalIndex sites);

/// True if the mesh is a valid one, but not of the points given beside it.
bool only_the_points_differ(const ValidationReport &found);

/// On standard error: that `subject` is not what it should be (`fault`), what to do, and the first
/// violations.
void print_violations(const std::string &subject, const std::string &fault, const std::string &remedy,
                      const ValidationReport &found);

} // namespace dovetail::cli
