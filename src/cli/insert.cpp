// dovetail insert: points into a mesh that is there.
#include "command.hpp"
#include "options.hpp"
#include "output.hpp"
#include "points_read.hpp"
#include "report.hpp"
#include "text.hpp"
#include "verdict.hpp"

#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/phases.hpp"
#include "dovetail/distributed/insert.hpp"
#include "dovetail/distributed/validate.hpp"
#include "dovetail/io/mesh_to_grow.hpp"
#include "dovetail/io/points.hpp"
#include "dovetail/mesh/checksum.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <memory>
#include <optional>

namespace dovetail::cli {
namespace {

struct InsertCommand {
  std::string mesh;
  std::vector<std::string> points;
  std::string output; ///< "none" to write nothing
  PointReading reading;
  DuplicateRule duplicates = DuplicateRule::first;
  Telling telling;
  bool writes() const { return output != "none"; }
  std::vector<std::string> inputs() const {
    std::vector<std::string> all{mesh};
    all.insert(all.end(), points.begin(), points.end());
    return all;
  }
};

const std::vector<std::string> phase_names{"read", "place", "paths", "insert", "stitch", "write"};
/// Shares of the time of ten thousand points into ten million on two ranks.
const std::vector<Stage> usual_shares{{"read", 3},   {"place", 0.1},  {"paths", 0.1},
                                      {"insert", 1}, {"stitch", 0.1}, {"write", 4}};

/// What is known of a finished run, the same on all ranks.
struct Outcome {
  PointInput input; ///< its points are gone
  DistributedMesh mesh;
  InsertStatistics inserted;
  std::vector<PhaseSummary> phases;
  std::int64_t peak_rss_max_bytes = 0;
  std::vector<std::string> files;             ///< written, the one to open last
  std::optional<ValidationReport> validation; ///< of a mesh that is not written
};

/// Reads both, and sees that the mesh can be worked with.
DistributedMesh read_inputs(const InsertCommand &command, const Communicator &comm, ProgressMeter &meter,
                            PointInput &input) {
  constexpr double share_of_points = 0.1; // of the time for both
  PointReading reading = command.reading;
  reading.progress = part_of_stage(progress_into(meter), 0, share_of_points);
  input = read_points(comm, command.points, reading);
  DistributedMesh mesh = read_mesh_to_grow(comm, command.mesh, input.read,
                                           part_of_stage(progress_into(meter), share_of_points, 1));
  require_sound_layout(comm, mesh, command.mesh);
  return mesh;
}

Outcome run_phases(const InsertCommand &command, const Communicator &comm) {
  std::vector<Stage> stages = usual_shares;
  if (!command.writes())
    stages.back() = {"check", 40};
  ProgressMeter meter(progress_style(comm.is_root(), command.telling), stages);
  PhaseLog phases(comm);
  Outcome outcome;

  meter.begin("read");
  DistributedMesh mesh =
      phases.measure("read", [&] { return read_inputs(command, comm, meter, outcome.input); });
  InsertOptions options{command.duplicates, progress_into(meter), &phases, command.mesh,
                        joined(command.points, " ")};
  GrownMesh grown = insert(comm, std::move(mesh), std::move(outcome.input.points), options);
  outcome.mesh = std::move(grown.mesh);
  outcome.inserted = std::move(grown.statistics);
  outcome.peak_rss_max_bytes = all_reduce_max(comm, peak_rss_bytes());
  if (command.writes()) {
    meter.begin("write");
    const MeshWriting writing{.progress = progress_into(meter)};
    outcome.files =
        phases.measure("write", [&] { return write_mesh(comm, outcome.mesh, command.output, writing); });
    outcome.peak_rss_max_bytes = all_reduce_max(comm, peak_rss_bytes());
  } else {
    meter.begin("check");
    outcome.validation =
        phases.measure("check", [&] { return validate(comm, outcome.mesh, progress_into(meter)); });
  }
  outcome.phases = summarise(comm, phases);
  return outcome;
}

Report report_of(const InsertCommand &command, const Session &session, const Outcome &outcome) {
  Report report = new_report(session, "insert", command.inputs());
  if (command.writes())
    report["output"] = command.output;
  report["withheld"] = outcome.input.withheld;
  report["other_class"] = outcome.input.other_class;
  report_mesh(report, outcome.mesh);
  if (outcome.validation)
    report["valid"] = outcome.validation->valid;
  report["peak_rss_max_bytes"] = outcome.peak_rss_max_bytes;
  report["inserted_points"] = outcome.inserted.points;
  report["inserted_sites"] = outcome.inserted.sites;
  report["inserted_duplicates"] = outcome.inserted.duplicates;
  report["changed_slabs"] = outcome.inserted.changed_slabs;
  report["phases"] = phases_as_json(phase_names, outcome.phases);
  return report;
}

void print_absent(const InsertStatistics &inserted) {
  for (const std::string &name : inserted.absent_in_points)
    print_row("notice", fmt::format("the points have no {}, which the mesh has, and got {}", name,
                                    value_of_absent(name)));
  for (const std::string &name : inserted.absent_in_mesh)
    print_row("notice", fmt::format("the mesh had no {}, which the points have, and its sites got {}", name,
                                    value_of_absent(name)));
}

/// Slabs that are much larger than others make ranks wait for each other, whatever is done with the mesh.
void print_uneven_slabs(const DistributedMesh &mesh) {
  constexpr double much = 2;
  constexpr GlobalIndex few = 1000; // sites a slab: nobody waits for so few
  const double imbalance = mesh.statistics.slab_imbalance(mesh.site_count(), mesh.slab_count());
  if (imbalance > much && mesh.site_count() > few * mesh.slab_count())
    print_row("notice", fmt::format("the largest slab has {:.1f} times its share of sites: triangulate all "
                                    "points anew, and slabs are even again",
                                    imbalance));
}

void print_outcome(const InsertCommand &command, const Session &session, const Outcome &outcome) {
  const DistributedMesh &mesh = outcome.mesh;
  const InsertStatistics &inserted = outcome.inserted;
  print_points_read(outcome.input);
  print_absent(inserted);
  print_row("inserted", fmt::format("{} into {}, and {} merged", counted(inserted.sites, "site", "sites"),
                                    command.mesh, counted(inserted.duplicates, "duplicate", "duplicates")));
  print_row("sites", with_separators(mesh.site_count()));
  print_row("triangles",
            fmt::format("{} in {} cut along {}, of which {} changed", with_separators(mesh.triangle_count()),
                        counted(mesh.slab_count(), "slab", "slabs"), axis_name(mesh.axis),
                        with_separators(inserted.changed_slabs)));
  if (mesh.triangle_count() == 0)
    print_row("notice", no_triangles_reason(mesh.site_count()));
  print_uneven_slabs(mesh);
  print_row("hull edges", with_separators(mesh.hull_edges));
  print_row("checksum", checksum_text(mesh.checksum));
  if (outcome.validation)
    print_row("checked", outcome.validation->valid ? "valid, in exact arithmetic" : "NOT VALID");
  print_row("time", times_text(session, outcome.phases));
  print_row("memory", fmt::format("{} on the largest of {}", size_text(outcome.peak_rss_max_bytes),
                                  counted(session.comm.size(), "rank", "ranks")));
  if (command.writes())
    print_row("wrote", files_text(outcome.files));
}

ExitCode run_insert(const InsertCommand &command, const Session &session) {
  const Communicator &comm = session.comm;
  const std::vector<std::string> inputs = command.inputs();
  std::vector<std::string> outputs;
  if (command.writes())
    outputs = check_mesh_output(comm, command.output, inputs);
  check_report(comm, command.telling.report, inputs, outputs);
  const Outcome outcome = run_phases(command, comm);
  write_report(session, report_of(command, session, outcome), command.telling.report);
  if (comm.is_root() && !command.telling.quiet)
    print_outcome(command, session, outcome);
  if (outcome.validation && !outcome.validation->valid) {
    if (comm.is_root())
      print_violations(command.mesh, "the mesh is not valid",
                       "if dovetail verify finds the mesh given valid, please report this fault of dovetail",
                       *outcome.validation);
    return failure;
  }
  return success;
}

constexpr const char *details =
    R"(Insert points into a mesh that dovetail has made: the triangulation of all points, old and new,
with the same checksum as if they had been triangulated together. The mesh keeps its slabs; slabs
that the points do not touch are copied. Points are numbered behind those that the mesh was made
from, so MESH's own points and then POINTS, in this order, are the points of the new mesh.

Of equal points the mesh keeps what it has (--duplicates first); lowest and highest let a new point
take the place of one with a higher or lower z, and error refuses points that equal others.
Attributes are matched by name.

Input:  a .vtkhdf file of dovetail, and points as triangulate reads them
Output, by the extension of FILE:
{}
Examples:
  dovetail insert survey.vtkhdf east.npy -o grown.vtkhdf
  mpirun -n 4 dovetail insert survey.vtkhdf east.npy west.npy -o all.vtkhdf --report all.json
  mpirun -n 2 dovetail insert survey.vtkhdf survey.las -o lower.vtkhdf --class 2 --duplicates lowest
  dovetail insert survey.vtkhdf east.npy -o none --progress
)";

} // namespace

Subcommand add_insert(CLI::App &app) {
  CLI::App *parser = app.add_subcommand("insert", "Insert points into a mesh that is there");
  parser->footer(fmt::format(details, mesh_outputs));
  const auto command = std::make_shared<InsertCommand>();
  parser->add_option("MESH", command->mesh, "Mesh to begin with: .vtkhdf")
      ->required()
      ->check(fault_of_name)
      ->option_text("FILE (required)");
  parser->add_option("POINTS", command->points, "Files of points: " + known_point_extensions())
      ->required()
      ->check(fault_of_name)
      ->option_text("FILE ... (required)");
  parser->add_option("-o,--output", command->output, "Mesh to write; none to check it and write nothing")
      ->required()
      ->option_text("FILE (required)");
  add_class_option(*parser, command->reading.classes);
  add_duplicates_option(*parser, command->duplicates,
                        "Which of equal points is kept: that of the mesh, or of lowest or highest z");
  add_telling_options(*parser, command->telling);
  return {parser, [command](const Session &session) { return run_insert(*command, session); }};
}

} // namespace dovetail::cli
