// dovetail constrain: from a domain file to its constrained Delaunay triangulation.
#include "command.hpp"
#include "domain_job.hpp"
#include "options.hpp"
#include "output.hpp"
#include "report.hpp"
#include "text.hpp"

#include "dovetail/comm/phases.hpp"
#include "dovetail/io/domain.hpp"
#include "dovetail/io/mesh.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <array>
#include <memory>

namespace dovetail::cli {
namespace {

struct ConstrainCommand {
  std::string input;
  std::string output;
  DomainOptions domain;
  Telling telling;
};

const std::vector<std::string> phase_names{"read", "constrain", "write"};

void print_result(const ConstrainCommand &command, const DomainJob &job, const DistributedMesh &mesh,
                  std::span<const std::string> files) {
  print_row("read", fmt::format("{} and {} from {}", counted(job.given_vertices, "vertex", "vertices"),
                                counted(job.given_segments, "segment", "segments"), command.input));
  print_row("repairs", repairs_text(job));
  for (const std::string &notice : job.notices)
    print_row("notice", notice);
  print_row("graph", fmt::format("{}, {}", counted(mesh.site_count(), "vertex", "vertices"),
                                 counted(std::ssize(record_of(mesh).segments), "segment", "segments")));
  print_row("triangles", with_separators(mesh.triangle_count()));
  print_row("boundary edges", with_separators(mesh.hull_edges));
  print_row("wrote", files_text(files));
}

ExitCode run_constrain(const ConstrainCommand &command, const Session &session) {
  require_one_rank(session, "constrain");
  const std::array inputs{command.input};
  const auto outputs = check_mesh_output(session.comm, command.output, inputs);
  check_report(session.comm, command.telling.report, inputs, outputs);
  ProgressMeter meter(progress_style(session.comm.is_root(), command.telling),
                      {{"read", 1}, {"constrain", 2}, {"write", 2}});
  PhaseLog phases(session.comm);
  meter.begin("read");
  DomainJob job = phases.measure("read", [&] { return domain_of_file(command.input, command.domain); });
  meter.begin("constrain");
  const DistributedMesh mesh = phases.measure("constrain", [&] {
    const Outline outline = command.domain.convex ? Outline::convex_hull : Outline::segments;
    Constrained constrained = constrain_domain(job, {.outline = outline});
    DomainRecord record = record_of(job, constrained);
    return slab_of_domain(std::move(constrained.mesh), std::move(record), job.vertices);
  });
  meter.begin("write");
  const auto files = phases.measure("write", [&] {
    return write_mesh(session.comm, mesh, command.output, {.progress = progress_into(meter)});
  });
  meter.finish();
  Report report = new_report(session, "constrain", inputs);
  report["output"] = command.output;
  report_domain(mesh, report);
  report["repairs"] = repairs_as_json(job);
  report["notices"] = job.notices;
  report["phases"] = phases_as_json(phase_names, summarise(session.comm, phases));
  write_report(session, std::move(report), command.telling.report);
  if (session.comm.is_root() && !command.telling.quiet)
    print_result(command, job, mesh, files);
  return success;
}

constexpr const char *details =
    R"(The domain is a .poly file of Triangle, or GeoJSON (.geojson, .json). Its segments become edges,
what is outside and in holes is carved away, and all else is as near to Delaunay as that allows.
Segments that cross, overlap, repeat or touch are brought in order first, and the repairs counted.
Runs on one rank. The output is one of
{}

Examples:
  dovetail constrain coast.poly -o coast.vtkhdf
  dovetail constrain parcels.geojson -o parcels.vtkhdf --crossings error
)";

} // namespace

Subcommand add_constrain(CLI::App &app) {
  CLI::App *parser = app.add_subcommand("constrain", "Triangulate a domain: outlines, holes and lines");
  parser->footer(fmt::format(details, mesh_outputs));
  const auto command = std::make_shared<ConstrainCommand>();
  parser->add_option("DOMAIN", command->input, fmt::format("Domain: {}", domain_extensions))
      ->required()
      ->check(fault_of_name)
      ->option_text("FILE (required)");
  parser->add_option("-o,--output", command->output, "Mesh to write")
      ->required()
      ->option_text("FILE (required)");
  add_domain_options(*parser, command->domain);
  add_telling_options(*parser, command->telling);
  return {parser, [command](const Session &session) { return run_constrain(*command, session); }};
}

} // namespace dovetail::cli
