/// One writer for each format of mesh files. Private to io.
///
/// All are Collective, write aside and commit, and return the files made, the main one last. The mesh has
/// been through check_indices.
#pragma once

#include "dovetail/io/mesh.hpp"

namespace dovetail {

using MeshWriter = std::vector<std::string>(const Communicator &comm, const DistributedMesh &mesh,
                                            const std::string &path, const MeshWriting &writing);

MeshWriter write_vtkhdf;
MeshWriter write_npy_arrays;
MeshWriter write_vtu;
MeshWriter write_pvtu;
MeshWriter write_ply;
MeshWriter write_msh;
MeshWriter write_triangle_files;

std::unique_ptr<SlabSink> stream_vtkhdf(const std::string &path, const MeshWriting &writing);

/// The name without its extension, for formats of several files.
std::string without_extension(const std::string &path);

/// The files of formats that make several, the main one last.
std::vector<std::string> npy_array_files(const std::string &path);
std::vector<std::string> triangle_files(const std::string &path);

} // namespace dovetail
