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

/// On standard error: that the mesh of `subject` is not valid, and the first violations.
void print_violations(const std::string &subject, const std::string &remedy, const ValidationReport &found);

} // namespace dovetail::cli
