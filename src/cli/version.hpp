/// Which dovetail this is and what it was built on.
#pragma once

#include <string>

namespace dovetail::cli {

/// Version of the project, such as "0.1.0".
std::string project_version();
/// What --version prints: project, file format and libraries, a line each. MPI must be initialised.
std::string version_text();

} // namespace dovetail::cli
