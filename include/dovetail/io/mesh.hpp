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
/// A mesh of a domain (format 2; others are format 1, which older programs read) has VTKHDF/CellData/region
///   i32 (T) and the group domain: attributes even_odd, hull_segments, given_vertices, min_angle; segments
///   i64 (S, 2), site numbers; segment_markers i32 (S); is_line u8 (none or S); holes f64 (H, 2); regions f64
///   (R, 4): x, y, attribute, greatest area; segment_of_side i32 (T, 3); chain_offsets, chain_vertices i64;
///   left_triangles i64. mesh/domain_record.hpp says what they are.
#pragma once

#include "dovetail/base/progress.hpp"
#include "dovetail/comm/communicator.hpp"
#include "dovetail/distributed/mesh.hpp"
#include "dovetail/distributed/slab_sink.hpp"
#include "dovetail/distributed/slab_source.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace dovetail {

/// The newest format that this library reads.
inline constexpr int mesh_format_version = 2;

struct MeshWriting {
  /// Columns pass through a buffer of this size, and no single write is larger.
  std::int64_t buffer_bytes = std::int64_t{8} << 20;
  Progress progress = {}; ///< stage "write": about how much of this rank's part
};

/// Collective. Writes the mesh in the format that the name's extension says (in small or capital letters):
///   .vtkhdf  the native file above, the only one that read_mesh takes
///   .vtu     VTK's XML file of the whole mesh: sites and triangles in global numbers; input indices and all
///            attributes but z, which is the third coordinate
///   .pvtu    the same for each slab, NAME.0.vtu and so on, in its own 32-bit numbers, with its ghosts, their
///            vtkGhostType and global numbers; the .pvtu itself names the parts
///   .ply     Polygon File Format, binary little endian: x, y, z (0 without one) and all other attributes as
///            double, faces as list uchar int; not more than 2^31 - 1 sites or triangles
///   .msh     Gmsh's MSH 4.1, binary: x, y, z, triangles, one partition for each slab; no other attributes
///   .node, .ele  Triangle's text files NAME.node, NAME.neigh and NAME.ele, numbered from 0. Nodes are all
///            points taken from the input, in its order: a corner in the .ele file is the number of a point
///            in the user's own file. Merged duplicates stay, named by no triangle, with their own z and else
///            their site's attributes. Where LAS records were skipped, nodes are numbered without gaps, as
///            the format wants it, and not by record. The mesh of a domain has NAME.poly too: subsegments
///            with markers, holes and regions. Attributes follow the coordinates, and "marker", if it
///            is whole numbers, is the boundary marker; doubles are the shortest decimals that read back the
///            same
///   .npy     NumPy arrays NAME.points.npy (sites in global order: x, y and the attributes, f64),
///            NAME.index.npy (their input indices, i64), NAME.neighbours.npy (T x 3, i64, -1 beyond the hull)
///            and NAME.triangles.npy (T x 3, i64, global numbers of sites)
/// Returns the files made, the one to open last; the same on all ranks.
///
/// Writes aside, to NAME.partial, and renames that once it is complete, all other files of an output before
/// the one to open: whatever happens, nothing incomplete is ever found under that name, and after an error
/// the partial files are gone. Every rank writes its own slabs, in bounded memory; the first one also what is
/// small. The bytes are a function of the mesh and its slabs, whatever the number of ranks. The space is
/// reserved before it is filled, where its size is known and the file system can do that. Errors (usage): an
/// extension that is none of these. (output, resource): no such folder, no permission, not enough space, file
/// size limit, a failing disk, attribute names or counts that the format cannot hold. (input): a mesh read
/// from a file whose indices lead nowhere.
std::vector<std::string> write_mesh(const Communicator &comm, const DistributedMesh &mesh,
                                    const std::string &path, const MeshWriting &writing = {});

/// Local. For a name that ends in .vtkhdf, where stream_mesh (distributed/stream_mesh.hpp) may leave a mesh:
/// the same bytes as write_mesh makes of it, written in the same way. Nothing for other formats.
std::unique_ptr<SlabSink> mesh_sink(const std::string &path, const MeshWriting &writing = {});

/// Local. The files that write_mesh would make for this name, the one to open last, as far as the name alone
/// tells. Error (usage): an unknown extension.
std::vector<std::string> mesh_files(const std::string &path);

/// Collective. On any number of ranks: rank r gets the slabs from first_slab_of_rank(r) on. Reading trusts
/// nothing: sizes are checked against each other and the file before memory is taken for them. What is wrong
/// with a mesh that a DistributedMesh can represent is left to `validate`.
/// Errors (input): missing, unreadable, truncated, not HDF5, not a mesh of ours, a newer format, a dataset
/// that is missing or has another type or shape, sizes that contradict each other. `progress`: stage "read",
/// how much of this rank's part.
DistributedMesh read_mesh(const Communicator &comm, const std::string &path, const Progress &progress = {});

/// Collective. The same mesh, of which only what all ranks share is read now, and each slab when it is asked
/// for. Errors as in read_mesh: those of slabs come from the SlabSource, on the rank that asks.
std::unique_ptr<SlabSource> open_mesh(const Communicator &comm, const std::string &path);

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
  std::optional<DomainRecord> domain; ///< without what there is one of for each triangle
  std::int64_t file_bytes = 0;
};

/// Collective; the same on all ranks. Reads the header, and the coordinates for the bounding box. Errors as
/// in read_mesh.
MeshDescription describe_mesh(const Communicator &comm, const std::string &path);

} // namespace dovetail
