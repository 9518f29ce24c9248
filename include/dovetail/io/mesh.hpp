/// The native mesh file, `.vtkhdf`: an HDF5 file that VTK's own reader takes as an UnstructuredGrid with one
/// partition for each slab, and beside it, in the group "dovetail", all else that a DistributedMesh holds.
///
/// The bytes of a file are a function of the mesh alone: the same for every number of ranks, on every day.
/// HDF5 1.8 and later read it; all its metadata has checksums.
///
/// Group VTKHDF (VTKHDF 1.0), for slabs s with V(s) vertices and T(s) triangles, one slab after the other:
///   Points f64 (V, 3), the third column being the attribute "z", or 0; Connectivity i32 (3 T) and Offsets
///   i32 (T(s) + 1 for every slab), local to a slab; Types u8 (T); NumberOfPoints, NumberOfCells,
///   NumberOfConnectivityIds i64 (slabs); PointData: vtkGhostType u8 (1 for ghosts), input_index i64,
///   global_number i64, and every further attribute f64, each (V).
/// Group dovetail: attributes format_version, program_version, axis ("x" or "y"), checksum, hull_edges,
///   digest_points, digest_hash; site_offsets, triangle_offsets, path_offsets, duplicate_offsets i64
///   (slabs + 1); own_counts i64 (slabs); lines f64 (slabs - 1); neighbours i64 (T, 3), global triangle
///   numbers across from each corner, -1 beyond the hull; paths i64, global site numbers, that of slab s
///   being its left line's; duplicates i64 (D, 2), input index and site; duplicate_z f64 (D), only if there
///   is a z; attributes, the names in order; coordinate_system/0, 1, ...: one dataset u8 a record.
#pragma once

#include "dovetail/comm/communicator.hpp"
#include "dovetail/distributed/mesh.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace dovetail {

/// What this library writes, and the newest it reads.
inline constexpr int mesh_format_version = 1;

struct MeshWriting {
  /// Columns pass through a buffer of this size, and no single write is larger.
  std::int64_t buffer_bytes = std::int64_t{8} << 20;
};

/// Collective. Writes aside, to `path`.partial, and renames that once it is complete: whatever happens,
/// nothing incomplete is ever found at `path`, and after an error the partial file is gone.
/// Every rank writes its own slabs, in bounded memory; the first one also what is small. The space is
/// reserved before it is filled, where the file system can do that. Errors (output, resource): no such
/// folder, no permission, not enough space, file size limit, a failing disk, attribute names that a file
/// cannot hold.
void write_mesh(const Communicator &comm, const DistributedMesh &mesh, const std::string &path,
                const MeshWriting &writing = {});

/// Collective. On any number of ranks: rank r gets the slabs from first_slab_of_rank(r) on. Reading trusts
/// nothing: sizes are checked against each other and the file before memory is taken for them. What is wrong
/// with a mesh that a DistributedMesh can represent is left to `validate`.
/// Errors (input): missing, unreadable, truncated, not HDF5, not a mesh of ours, a newer format, a dataset
/// that is missing or has another type or shape, sizes that contradict each other.
DistributedMesh read_mesh(const Communicator &comm, const std::string &path);

/// What can be said of a mesh file without reading its triangles.
struct MeshDescription {
  int format_version = 0;
  std::string program_version; ///< of the program that wrote it
  Axis axis = Axis::x;
  int slabs = 0;
  GlobalIndex sites = 0;
  GlobalIndex ghosts = 0; ///< of all slabs together
  GlobalIndex triangles = 0;
  GlobalIndex hull_edges = 0;
  GlobalIndex duplicates = 0;
  GlobalIndex path_sites = 0; ///< of all paths together
  std::uint64_t checksum = 0;
  InputDigest digest;
  Point lowest{0, 0}, highest{0, 0}; ///< the bounding box of the sites; zeros if there are none
  std::vector<std::string> attributes;
  std::vector<CoordinateSystemRecord> coordinate_system;
  std::int64_t file_bytes = 0;
};

/// Collective; the same on all ranks. Reads the header, and the coordinates for the bounding box. Errors as
/// in read_mesh.
MeshDescription describe_mesh(const Communicator &comm, const std::string &path);

} // namespace dovetail
