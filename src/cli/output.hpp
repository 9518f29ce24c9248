/// What can be known about an output before any work is done for it, and small files written whole or not at
/// all.
#pragma once

#include "dovetail/comm/communicator.hpp"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dovetail::cli {

/// Collective. Nobody shall wait an hour for a typing error: throws an Error of kind output (usage for the
/// extension) unless `path` can be made now, that is, its folder exists and may be written to, it is no
/// folder itself, and it is none of `inputs`. `extensions`, if not empty, are those allowed, such as ".npy".
/// Looks from the root alone.
void check_output(const Communicator &comm, const std::string &path, std::span<const std::string> inputs,
                  std::span<const std::string_view> extensions);

/// Collective. The same for points, whose name's extension must be one that write_points knows.
void check_points_output(const Communicator &comm, const std::string &path,
                         std::span<const std::string> inputs);

/// Collective. The same for every file of a mesh, and returns them (io/mesh.hpp: mesh_files). The name's
/// extension must be that of a mesh format.
std::vector<std::string> check_mesh_output(const Communicator &comm, const std::string &path,
                                           std::span<const std::string> inputs);

/// The files of an output and the size of them all, for people: each by its name if they are few.
std::string files_text(std::span<const std::string> files);

/// Collective. The same for the file of --report, which is to be none of `outputs` either; an empty name is
/// none and is always right.
void check_report(const Communicator &comm, const std::string &report, std::span<const std::string> inputs,
                  std::span<const std::string> outputs);

/// Collective; only the root's text counts. `path` becomes the whole text or stays what it was. Throws an
/// Error of kind output.
void write_text_file(const Communicator &comm, const std::string &path, const std::string &text);

} // namespace dovetail::cli
