#include "dovetail/io/libraries.hpp"

#include <fmt/format.h>
#include <hdf5.h>
#include <mpi.h>

#include <array>

namespace dovetail {

LibraryVersions library_versions() {
  LibraryVersions versions;
  std::array<char, MPI_MAX_LIBRARY_VERSION_STRING> text{};
  int length = 0;
  MPI_Get_library_version(text.data(), &length);
  // Some libraries tell a whole paragraph about how they were built, and some count the final zero.
  versions.mpi = text.data();
  versions.mpi = versions.mpi.substr(0, versions.mpi.find_first_of("\n\r"));
  unsigned major = 0;
  unsigned minor = 0;
  unsigned release = 0;
  H5get_libversion(&major, &minor, &release);
  versions.hdf5 = fmt::format("{}.{}.{}", major, minor, release);
  return versions;
}

} // namespace dovetail
