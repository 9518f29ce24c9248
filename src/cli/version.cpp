#include "version.hpp"

#include "dovetail/io/libraries.hpp"
#include "dovetail/io/mesh.hpp"

#include <fmt/format.h>

namespace dovetail::cli {

std::string project_version() { return DOVETAIL_VERSION; }

std::string version_text() {
  const LibraryVersions libraries = library_versions();
  return fmt::format("dovetail {}\nmesh format {}\nMPI: {}\nHDF5 {}", project_version(), mesh_format_version,
                     libraries.mpi, libraries.hdf5);
}

} // namespace dovetail::cli
