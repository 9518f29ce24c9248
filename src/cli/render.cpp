// dovetail render: a picture of a mesh.
#include "command.hpp"
#include "options.hpp"
#include "output.hpp"
#include "report.hpp"
#include "text.hpp"

#include "dovetail/comm/phases.hpp"
#include "dovetail/distributed/validate.hpp"
#include "dovetail/io/mesh.hpp"
#include "dovetail/io/picture.hpp"
#include "dovetail/mesh/checksum.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>

namespace dovetail::cli {
namespace {

struct RenderCommand {
  std::string mesh;
  std::string output;
  PictureOptions options;
  Telling telling;
};

constexpr std::array<std::string_view, 2> picture_extensions{".png", ".svg"};
const std::map<std::string, Colouring> colourings{{"slab", Colouring::slab},
                                                  {"angle", Colouring::angle},
                                                  {"area", Colouring::area},
                                                  {"elevation", Colouring::elevation}};

/// "0,0,10,5.5" as a window.
Window window_from_text(const std::string &text) {
  std::array<double, 4> corners{};
  const char *rest = text.c_str();
  for (std::size_t i = 0; i < 4; ++i) {
    char *end = nullptr;
    corners[i] = std::strtod(rest, &end);
    if (end == rest || *end != (i < 3 ? ',' : '\0') || !std::isfinite(corners[i]))
      throw CLI::ValidationError(
          "--window", "'" + text + "' is not x0,y0,x1,y1: the lower left and the upper right corner");
    rest = end + 1;
  }
  return {corners[0], corners[1], corners[2], corners[3]};
}

ExitCode run_render(const RenderCommand &command, const Session &session) {
  const Communicator &comm = session.comm;
  const std::vector inputs{command.mesh};
  check_output(comm, command.output, inputs, picture_extensions);
  check_report(comm, command.telling.report, inputs, std::span(&command.output, 1));
  ProgressMeter meter(progress_style(comm.is_root(), command.telling), {{"read", 2}, {"draw", 3}});
  PhaseLog phases(comm);
  meter.begin("read");
  const DistributedMesh mesh =
      phases.measure("read", [&] { return read_mesh(comm, command.mesh, progress_into(meter)); });
  meter.begin("draw");
  phases.measure("draw", [&] {
    require_sound_layout(comm, mesh, command.mesh);
    PictureOptions options = command.options;
    options.progress = progress_into(meter);
    write_picture(comm, mesh, command.output, options);
  });
  meter.finish();
  const std::vector<PhaseSummary> times = summarise(comm, phases);
  Report report = new_report(session, "render", inputs);
  report["output"] = command.output;
  report["slabs"] = mesh.slab_count();
  report["points"] = mesh.digest.points;
  report["sites"] = mesh.site_count();
  report["triangles"] = mesh.triangle_count();
  report["hull_edges"] = mesh.hull_edges;
  report["checksum"] = checksum_text(mesh.checksum);
  report["phases"] = phases_as_json({}, times);
  write_report(session, std::move(report), command.telling.report);
  if (comm.is_root() && !command.telling.quiet) {
    print_row("drew",
              fmt::format("{} of {}", counted(mesh.triangle_count(), "triangle", "triangles"), command.mesh));
    print_row("time", times_text(session, times));
    print_row("wrote", command.output);
  }
  return success;
}

constexpr const char *details =
    R"(Draw a mesh: every triangle in the colour of what --by names, edges where there is room for them,
and a legend. A PNG may be of any number of triangles, an SVG of up to 100,000. The picture is the
same for every number of ranks, and its colours can be told apart by the colour-blind.

Examples:
  dovetail render survey.vtkhdf -o survey.png --by elevation
  mpirun -n 4 dovetail render stars.vtkhdf -o slabs.png --paths --hull
  mpirun -n 4 dovetail render stars.vtkhdf -o areas.png --by area --window -2,-2,2,2
  dovetail render stars.vtkhdf -o angles.svg --by angle --width 800
)";

} // namespace

Subcommand add_render(CLI::App &app) {
  CLI::App *parser = app.add_subcommand("render", "Draw a mesh as a picture");
  parser->footer(details);
  const auto command = std::make_shared<RenderCommand>();
  parser->add_option("MESH", command->mesh, "Mesh to draw: .vtkhdf")
      ->required()
      ->check(fault_of_name)
      ->option_text("FILE (required)");
  parser->add_option("-o,--output", command->output, "Picture to write")
      ->required()
      ->option_text("FILE.png|.svg (required)");
  add_word_option(*parser, "--by", command->options.colouring, colourings,
                  "What colours mean: slab, smallest angle, area, or z with shaded relief")
      ->option_text("slab|angle|area|elevation [slab]");
  parser->add_flag("--paths", command->options.paths, "Draw the split paths between slabs");
  parser->add_flag("--hull", command->options.hull, "Draw the convex hull");
  parser
      ->add_option_function<std::string>(
          "--window",
          [command](const std::string &text) { command->options.window = window_from_text(text); },
          "Draw this part alone")
      ->option_text("x0,y0,x1,y1");
  parser->add_option("--width", command->options.width, "Width in pixels; the height follows")
      ->check(CLI::Range(least_picture_width, most_picture_width))
      ->option_text("PIXELS [1600]");
  add_telling_options(*parser, command->telling);
  return {parser, [command](const Session &session) { return run_render(*command, session); }};
}

} // namespace dovetail::cli
