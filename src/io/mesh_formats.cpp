// The table of mesh formats, by extension, and the way from a name to its writer.
#include "mesh_formats.hpp"

#include "mesh_rows.hpp"
#include "points_share.hpp"

#include "dovetail/comm/agreement.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>

namespace dovetail {
namespace {

struct Format {
  std::string_view extension; ///< in small letters
  MeshWriter *write;
  /// The files that it makes, as far as the name tells, the main one last; null: that of the name alone.
  std::vector<std::string> (*files)(const std::string &path);
};

constexpr std::array formats{
    Format{".vtkhdf", write_vtkhdf, nullptr},
    Format{".vtu", write_vtu, nullptr},
    Format{".pvtu", write_pvtu, nullptr},
    Format{".ply", write_ply, nullptr},
    Format{".msh", write_msh, nullptr},
    Format{".node", write_triangle_files, triangle_files},
    Format{".ele", write_triangle_files, triangle_files},
    Format{".npy", write_npy_arrays, npy_array_files},
};

const Format &format_of(const std::string &path) {
  const std::string extension = extension_of(path);
  for (const Format &format : formats)
    if (format.extension == extension)
      return format;
  std::string known;
  for (const Format &format : formats)
    known += fmt::format("{}{}",
                         known.empty()                                  ? ""
                         : format.extension == formats.back().extension ? " or "
                                                                        : ", ",
                         format.extension);
  throw Error({ErrorKind::usage, path, "",
               extension.empty() ? "an output without an extension"
                                 : fmt::format("'{}' is not the extension of a mesh file", extension),
               "let the name end in " + known});
}

} // namespace

std::string without_extension(const std::string &path) {
  return path.substr(0, path.size() - std::filesystem::path(path).extension().string().size());
}

std::unique_ptr<SlabSink> mesh_sink(const std::string &path, const MeshWriting &writing) {
  return format_of(path).write == write_vtkhdf ? stream_vtkhdf(path, writing) : nullptr;
}

std::vector<std::string> mesh_files(const std::string &path) {
  const Format &format = format_of(path);
  return format.files == nullptr ? std::vector{path} : format.files(path);
}

std::vector<std::string> write_mesh(const Communicator &comm, const DistributedMesh &mesh,
                                    const std::string &path, const MeshWriting &writing) {
  const Format &format = format_of(path); // the same on all ranks
  collectively(comm, [&] { check_indices(mesh, path); });
  return format.write(comm, mesh, path, writing);
}

} // namespace dovetail
