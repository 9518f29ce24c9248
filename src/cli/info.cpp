// dovetail info: what a file holds.
#include "command.hpp"
#include "options.hpp"
#include "text.hpp"
#include "verdict.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/io/mesh.hpp"
#include "dovetail/io/points.hpp"
#include "dovetail/mesh/checksum.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <memory>

namespace dovetail::cli {
namespace {

std::string box_text(Point lowest, Point highest) {
  return fmt::format("x {} to {}, y {} to {}", lowest.x, highest.x, lowest.y, highest.y);
}

void print_domain(const DomainRecord &domain) {
  print_row("domain",
            fmt::format("{} given, {}, {}, {}", counted(domain.given_vertices, "vertex", "vertices"),
                        counted(std::ssize(domain.segments), "segment", "segments"),
                        counted(std::ssize(domain.holes), "hole seed", "hole seeds"),
                        counted(std::ssize(domain.regions), "region", "regions")));
  print_row("refined to", domain.min_angle > 0 ? fmt::format("{:g} degrees", domain.min_angle) : "no angle");
}

void print_mesh(const std::string &path, const MeshDescription &mesh) {
  print_row("mesh", path);
  print_row("format", fmt::format("{}, written by dovetail {}", mesh.format_version, mesh.program_version));
  print_row("file size", size_text(mesh.file_bytes));
  print_row("input points", with_separators(mesh.digest.points));
  print_row("sites", with_separators(mesh.sites));
  print_row("duplicates", with_separators(mesh.duplicates));
  print_row("triangles", with_separators(mesh.triangles));
  print_row(mesh.domain ? "boundary edges" : "hull edges", with_separators(mesh.hull_edges));
  print_row("checksum", checksum_text(mesh.checksum));
  print_row("input digest", checksum_text(mesh.digest.hash));
  print_row("slabs", fmt::format("{}, cut along {}", with_separators(mesh.slabs), axis_name(mesh.axis)));
  if (mesh.domain)
    print_domain(*mesh.domain);
  print_row("path sites", with_separators(mesh.path_sites));
  print_row("ghosts", with_separators(mesh.ghosts));
  print_row("box", mesh.sites > 0 ? box_text(mesh.lowest, mesh.highest) : "empty");
  print_row("attributes", mesh.attributes.empty() ? "none" : joined(mesh.attributes, ", "));
  for (const CoordinateSystemRecord &record : mesh.coordinate_system)
    print_row("coordinate system", description_line(record));
}

void inform_of_mesh(const Communicator &comm, const std::string &path) {
  const MeshDescription mesh = describe_mesh(comm, path);
  if (comm.is_root())
    print_mesh(path, mesh);
}

void inform_of_points(const Communicator &comm, const std::string &path) {
  const auto lines = collectively(comm, [&] {
    return comm.is_root() ? description_lines(describe_points(path)) : std::vector<std::string>();
  });
  if (comm.is_root())
    print_row("file of points", path);
  for (const std::string &line : lines)
    fmt::print("{}\n", line);
}

constexpr const char *examples = R"(Examples:
  dovetail info stars.vtkhdf
  dovetail info survey.las
)";

} // namespace

Subcommand add_info(CLI::App &app) {
  CLI::App *parser = app.add_subcommand("info", "Say what a file of points or a mesh holds");
  parser->footer(examples);
  const auto path = std::make_shared<std::string>();
  parser->add_option("FILE", *path, fmt::format("Points ({}) or a mesh (.vtkhdf)", known_point_extensions()))
      ->required()
      ->check(fault_of_name)
      ->option_text("(required)");
  return {parser, [path](const Session &session) {
            if (extension_of(*path) == ".vtkhdf")
              inform_of_mesh(session.comm, *path);
            else
              inform_of_points(session.comm, *path);
            return success;
          }};
}

} // namespace dovetail::cli
