// dovetail convert: a mesh or points in another format.
#include "command.hpp"
#include "options.hpp"
#include "output.hpp"
#include "report.hpp"
#include "text.hpp"

#include "dovetail/comm/phases.hpp"
#include "dovetail/io/mesh.hpp"
#include "dovetail/io/points.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <array>
#include <memory>

namespace dovetail::cli {
namespace {

struct ConvertOptions {
  std::string input;
  std::string output;
  PointReading reading;
  Telling telling;
};

const std::vector<std::string> phase_names{"read", "write"};

/// What a run has to tell, the same on all ranks.
struct Converted {
  std::vector<std::string> files; ///< made, the one to open last
  std::string what;               ///< was read, for people
};

Converted convert_mesh(const ConvertOptions &options, const Communicator &comm, PhaseLog &phases,
                       ProgressMeter &meter, Report &report) {
  const DistributedMesh mesh =
      phases.measure("read", [&] { return read_mesh(comm, options.input, progress_into(meter)); });
  meter.begin("write");
  Converted result;
  result.files = phases.measure(
      "write", [&] { return write_mesh(comm, mesh, options.output, {.progress = progress_into(meter)}); });
  result.what = fmt::format("{} of {} from {}", counted(mesh.triangle_count(), "triangle", "triangles"),
                            counted(mesh.site_count(), "site", "sites"), options.input);
  report_counts(report, mesh);
  report["points"] = mesh.digest.points;
  return result;
}

Converted convert_points(const ConvertOptions &options, const Communicator &comm, PhaseLog &phases,
                         ProgressMeter &meter, Report &report) {
  PointReading reading = options.reading;
  reading.progress = progress_into(meter);
  const PointInput input =
      phases.measure("read", [&] { return read_points(comm, std::span(&options.input, 1), reading); });
  meter.begin("write");
  phases.measure(
      "write", [&] { write_points(comm, input.points, options.output, {.progress = progress_into(meter)}); });
  report["points"] = input.read;
  report["withheld"] = input.withheld;
  report["other_class"] = input.other_class;
  return {{options.output}, fmt::format("{} from {}", counted(input.read, "point", "points"), options.input)};
}

ExitCode convert(const ConvertOptions &options, const Session &session) {
  const Communicator &comm = session.comm;
  const bool is_mesh = extension_of(options.input) == ".vtkhdf";
  const std::array inputs{options.input};
  std::vector<std::string> outputs{options.output};
  if (is_mesh)
    outputs = check_mesh_output(comm, options.output, inputs);
  else
    check_points_output(comm, options.output, inputs);
  check_report(comm, options.telling.report, inputs, outputs);

  ProgressMeter meter(progress_style(comm.is_root(), options.telling), {{"read", 1}, {"write", 2}});
  PhaseLog phases(comm);
  Report report = new_report(session, "convert", inputs);
  report["output"] = options.output;
  meter.begin("read");
  const Converted converted = (is_mesh ? convert_mesh : convert_points)(options, comm, phases, meter, report);
  meter.finish();

  const std::vector<PhaseSummary> times = summarise(comm, phases);
  report["phases"] = phases_as_json(phase_names, times);
  write_report(session, std::move(report), options.telling.report);
  if (comm.is_root() && !options.telling.quiet) {
    print_row("read", converted.what);
    print_row("time", times_text(session, times));
    print_row("wrote", files_text(converted.files));
  }
  return success;
}

constexpr const char *details =
    R"(A mesh (.vtkhdf) becomes another kind of mesh file, by the extension of OUT:
{}
Points become another kind of point file, by its extension: {}.

Examples:
  dovetail convert stars.vtkhdf stars.npy
  mpirun -n 2 dovetail convert stars.vtkhdf stars.ele
  dovetail convert survey.las ground.csv --class 2
)";

} // namespace

Subcommand add_convert(CLI::App &app) {
  CLI::App *parser = app.add_subcommand("convert", "Write a mesh or points in another format");
  parser->footer(fmt::format(details, mesh_outputs, known_point_extensions(true)));
  const auto options = std::make_shared<ConvertOptions>();
  parser
      ->add_option("IN", options->input,
                   fmt::format("Mesh (.vtkhdf) or points ({})", known_point_extensions()))
      ->required()
      ->option_text("FILE (required)");
  parser->add_option("OUT", options->output, "File to write")->required()->option_text("FILE (required)");
  add_class_option(*parser, options->reading.classes);
  add_telling_options(*parser, options->telling);
  return {parser, [options](const Session &session) { return convert(*options, session); }};
}

} // namespace dovetail::cli
