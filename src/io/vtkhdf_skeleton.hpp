/// The file without its long columns' contents: what one rank makes. Private to io.
#pragma once

#include "vtkhdf.hpp"

#include "dovetail/distributed/mesh.hpp"

#include <map>

namespace dovetail::vtkhdf {

/// Refuses (Error, usage) names that PointData cannot hold, or has already.
void check_attribute_names(const std::vector<std::string> &names, const std::string &path);

/// No less than the size of the file.
std::int64_t estimated_bytes(const DistributedMesh &mesh, const Extents &extents,
                             const std::vector<std::string> &names);

struct Skeleton {
  std::int64_t file_bytes = 0;                      ///< which will not change any more
  std::map<std::string, std::int64_t> column_bytes; ///< where each long column begins in the file
};

/// Local. Makes all groups, attributes and datasets, the long columns with their space but without contents.
/// Throws hdf5::Failure.
Skeleton make_skeleton(const std::string &path, const DistributedMesh &mesh, const Extents &extents,
                       const std::vector<std::string> &names);

/// Local. Sets what is known only when all triangles are; the bytes are then those of a skeleton that was
/// made with it. Throws hdf5::Failure.
void set_results(const std::string &path, std::uint64_t checksum, GlobalIndex hull_edges);

} // namespace dovetail::vtkhdf
