#include "output.hpp"

#include "text.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/io/mesh.hpp"
#include "dovetail/io/output_file.hpp"
#include "dovetail/io/points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <unistd.h>
#include <utility>

namespace dovetail::cli {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string &path, std::string what, std::string remedy,
                         ErrorKind kind = ErrorKind::output) {
  throw Error(Problem{kind, path, "", std::move(what), std::move(remedy)});
}

[[noreturn]] void refuse_empty() {
  refuse("", "the name of an output is empty", "name a file", ErrorKind::usage);
}

[[noreturn]] void refuse_extension(const std::string &path, std::string what, std::string remedy) {
  if (extension_of(path).empty())
    what = "an output without an extension";
  refuse(path, std::move(what), std::move(remedy), ErrorKind::usage);
}

/// Also if neither exists yet.
bool same_target(const std::string &one, const std::string &other) {
  const auto target = [](const std::string &path) {
    std::error_code ignored;
    return fs::weakly_canonical(output_target(path), ignored);
  };
  return one == other || target(one) == target(other);
}

void check_here(const std::string &path, std::span<const std::string> inputs,
                std::span<const std::string_view> extensions) {
  if (path.empty())
    refuse_empty();
  const fs::path file(path);
  if (!extensions.empty() &&
      std::find(extensions.begin(), extensions.end(), extension_of(path)) == extensions.end())
    refuse_extension(path, fmt::format("'{}' is not an output format", file.extension().string()),
                     "let the name end in " + joined(extensions, " or "));

  std::error_code ignored;
  if (fs::is_directory(file, ignored))
    refuse(path, "is a folder", "name a file in it");
  const fs::path target(output_target(path));
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  if (!fs::exists(folder, ignored))
    refuse(path, fmt::format("the folder {} does not exist", folder.string()),
           "make it first, or correct the name");
  if (!fs::is_directory(folder, ignored))
    refuse(path, fmt::format("{} is not a folder", folder.string()), "correct the name");
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    refuse(path,
           fmt::format("the folder {} cannot be written to ({})", folder.string(), std::strerror(errno)),
           "choose another folder, or change its permissions");
  // Replacing it would need the folder's permission alone, but whoever made it read-only meant to keep it.
  if (fs::exists(file, ignored) && access(path.c_str(), W_OK) != 0)
    refuse(path, fmt::format("is there and cannot be written to ({})", std::strerror(errno)),
           "choose another name, or change its permissions");
  for (const std::string &input : inputs)
    if (path == input || fs::equivalent(file, input, ignored))
      refuse(path, "is an input of this run", "give the output another name", ErrorKind::usage);
}

} // namespace

void check_output(const Communicator &comm, const std::string &path, std::span<const std::string> inputs,
                  std::span<const std::string_view> extensions) {
  collectively(comm, [&] {
    if (comm.is_root())
      check_here(path, inputs, extensions);
  });
}

void check_points_output(const Communicator &comm, const std::string &path,
                         std::span<const std::string> inputs) {
  if (path.empty())
    refuse_empty();
  const std::span<const PointExtension> known = point_extensions();
  const std::string extension = extension_of(path);
  if (std::none_of(known.begin(), known.end(),
                   [&](const PointExtension &each) { return each.written && each.extension == extension; }))
    refuse_extension(path, fmt::format("points are not written as '{}'", extension),
                     fmt::format("let the name end in {}; a mesh of points is made by dovetail triangulate",
                                 known_point_extensions(true)));
  check_output(comm, path, inputs, {});
}

std::vector<std::string> check_mesh_output(const Communicator &comm, const std::string &path,
                                           std::span<const std::string> inputs) {
  if (path.empty())
    refuse_empty();
  std::vector<std::string> files = mesh_files(path);
  for (const std::string &file : files)
    check_output(comm, file, inputs, {});
  return files;
}

std::string files_text(std::span<const std::string> files) {
  std::int64_t bytes = 0;
  for (const std::string &file : files) {
    std::error_code ignored;
    const auto size = fs::file_size(file, ignored);
    bytes += ignored ? 0 : static_cast<std::int64_t>(size);
  }
  constexpr std::size_t few = 4;
  const std::string names = files.size() <= few
                                ? joined(files, ", ")
                                : fmt::format("{} and its {} parts", files.back(), files.size() - 1);
  return fmt::format("{}, {}", names, size_text(bytes));
}

void check_report(const Communicator &comm, const std::string &report, std::span<const std::string> inputs,
                  std::span<const std::string> outputs) {
  if (report.empty())
    return;
  collectively(comm, [&] {
    if (comm.is_root() && std::any_of(outputs.begin(), outputs.end(),
                                      [&](const std::string &output) { return same_target(report, output); }))
      refuse(report, "is both the output and the report", "give the report another name", ErrorKind::usage);
  });
  check_output(comm, report, inputs, {});
}

void write_text_file(const Communicator &comm, const std::string &path, const std::string &text) {
  OutputFile file(comm, path);
  collectively(comm, [&] {
    if (comm.is_root())
      file.write_at(0, std::as_bytes(std::span(text)));
  });
  file.commit();
}

} // namespace dovetail::cli
