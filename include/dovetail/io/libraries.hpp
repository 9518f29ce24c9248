/// The libraries that a build runs on, for reports and --version.
#pragma once

#include <string>

namespace dovetail {

struct LibraryVersions {
  std::string mpi;  ///< the library's own words, one line
  std::string hdf5; ///< such as "1.10.8"
};

/// Local. MPI must be initialised.
LibraryVersions library_versions();

} // namespace dovetail
