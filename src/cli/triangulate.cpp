// dovetail triangulate: from point files to a mesh file.
#include "command.hpp"
#include "options.hpp"
#include "output.hpp"
#include "plan.hpp"
#include "points_read.hpp"
#include "report.hpp"
#include "split_trace.hpp"
#include "text.hpp"
#include "verdict.hpp"

#include "dovetail/base/error.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/phases.hpp"
#include "dovetail/distributed/sort_on_disk.hpp"
#include "dovetail/distributed/triangulate.hpp"
#include "dovetail/distributed/validate.hpp"
#include "dovetail/io/mesh.hpp"
#include "dovetail/io/points.hpp"
#include "dovetail/mesh/checksum.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <chrono>
#include <map>
#include <memory>
#include <optional>

namespace dovetail::cli {
namespace {

struct TriangulateCommand {
  std::vector<std::string> inputs;
  std::string output; ///< "none" to write nothing
  PointReading reading;
  SlabOptions slabs;
  Kernel kernel = Kernel::merge;
  bool trace = false; ///< of the kernel split-path
  Room room;
  bool dry_run = false;
  Telling telling;
  bool writes() const { return output != "none"; }
};

const std::vector<std::string> phase_names{"read", "sort", "split", "triangulate", "stitch", "write"};
/// Shares of the time of ten million points on two ranks.
const std::vector<Stage> usual_shares{{"read", 0.5},       {"sort", 2.5},   {"split", 0.3},
                                      {"triangulate", 15}, {"stitch", 0.1}, {"write", 3}};

/// Whether the mesh need not be in memory as a whole.
bool streams(const TriangulateCommand &command) {
  return command.writes() && mesh_sink(command.output) != nullptr;
}

/// What is known of a finished run, the same on all ranks.
struct Outcome {
  Plan plan;
  PointInput input; ///< its points are gone
  DistributedMesh mesh;
  std::vector<PhaseSummary> phases;
  std::int64_t peak_rss_max_bytes = 0;
  std::vector<std::string> files;             ///< written, the one to open last
  std::optional<ValidationReport> validation; ///< of a mesh that is not written
  std::optional<SplitTraceSummary> split_trace;
};

/// Where a mesh goes that is only counted.
class NoSink : public SlabSink {
public:
  void begin(const Communicator &, const MeshOutline &) override {}
  void take(int, const SlabMesh &, std::span<const Duplicate>) override {}
  void complete(int, const SlabMesh &) override {}
  void finish(std::uint64_t, GlobalIndex) override {}
};

/// Slabs are made and written in turns: one stage of a run to who watches it. How its time is shared between
/// the two is a matter of the disk, so it is measured.
class SlabProgress {
public:
  SlabProgress(Progress progress, bool writes) : progress_(std::move(progress)), writes_(writes) {}

  Progress making() {
    return [this](std::string_view stage, double fraction) {
      if (stage == "triangulate")
        return tell(making_, fraction);
      over_ = making_.done > 0;
      report_progress(progress_, stage, fraction);
    };
  }
  Progress writing() {
    return [this](std::string_view, double fraction) { tell(writing_, fraction); };
  }

private:
  using Clock = std::chrono::steady_clock;
  struct Part {
    double done = 0; ///< 0 to 1
    Clock::duration took = {};
  };

  void tell(Part &part, double fraction) {
    const Clock::time_point now = Clock::now();
    if (fraction > 0)
      part.took += now - last_;
    part.done = fraction;
    last_ = now;
    if (!over_)
      report_progress(progress_, "triangulate", fraction_done());
  }

  /// As if both went on as they did; nothing before something is known of both.
  double fraction_done() const {
    if (!writes_)
      return making_.done;
    if (making_.done <= 0 || writing_.done <= 0)
      return 0;
    const auto seconds = [](const Part &part) { return std::chrono::duration<double>(part.took).count(); };
    const double all = seconds(making_) / making_.done + seconds(writing_) / writing_.done;
    return (seconds(making_) + seconds(writing_)) / all;
  }

  Progress progress_;
  bool writes_;
  Part making_, writing_;
  Clock::time_point last_; ///< when something was told
  bool over_ = false;
};

/// Into a file that takes slabs one by one, or only counted.
void stream_phases(const TriangulateCommand &command, const Communicator &comm, PointFiles &files,
                   const Plan &plan, TriangulateOptions options, Outcome &outcome) {
  SlabProgress progress(options.slabs.progress, command.writes());
  options.slabs.progress = progress.making();
  NoSink nowhere;
  const auto sink = command.writes() ? mesh_sink(command.output, {.progress = progress.writing()}) : nullptr;
  SlabSink &into = sink ? *sink : nowhere;
  if (plan.forecast.on_disk) {
    options.memory_bytes = plan.usable_bytes; // with sites in memory they are not all that is there
    const DiskSort disk{plan.scratch, plan.usable_bytes, most_slab_sites(plan.usable_bytes)};
    Slabs slabs =
        options.phases->measure("sort", [&] { return sort_on_disk(comm, files, options.slabs, disk); });
    outcome.input = std::move(files.input());
    outcome.mesh = triangulate_into(comm, std::move(slabs), into, outcome.input.coordinate_system, options);
  } else {
    outcome.input =
        options.phases->measure("read", [&] { return read_points(comm, command.inputs, command.reading); });
    outcome.mesh = triangulate_into(comm, std::move(outcome.input.points), into,
                                    outcome.input.coordinate_system, options);
  }
  if (command.writes())
    outcome.files = mesh_files(command.output);
}

/// The whole mesh in memory, then written or checked.
void whole_phases(const TriangulateCommand &command, const Communicator &comm, ProgressMeter &meter,
                  const TriangulateOptions &options, Outcome &outcome) {
  outcome.input =
      options.phases->measure("read", [&] { return read_points(comm, command.inputs, command.reading); });
  outcome.mesh = triangulate(comm, std::move(outcome.input.points), options);
  outcome.mesh.coordinate_system = outcome.input.coordinate_system;
  outcome.peak_rss_max_bytes = all_reduce_max(comm, peak_rss_bytes());
  if (command.writes()) {
    meter.begin("write");
    const MeshWriting writing{.progress = progress_into(meter)};
    outcome.files = options.phases->measure(
        "write", [&] { return write_mesh(comm, outcome.mesh, command.output, writing); });
    outcome.peak_rss_max_bytes = all_reduce_max(comm, peak_rss_bytes());
  } else {
    meter.begin("check");
    outcome.validation = options.phases->measure(
        "check", [&] { return validate(comm, outcome.mesh, options.slabs.progress); });
  }
}

Outcome run_phases(const TriangulateCommand &given, const Communicator &comm, PointFiles &files,
                   const Plan &plan, ProgressMeter &meter) {
  TriangulateCommand command = given;
  command.reading.progress = progress_into(meter);
  PhaseLog phases(comm);
  SplitTrace trace;
  TriangulateOptions options{command.slabs, &phases, {command.kernel, command.trace ? &trace : nullptr}};
  options.slabs.progress = progress_into(meter);
  options.slabs.subject = joined(command.inputs, " ");
  Outcome outcome;
  outcome.plan = plan;
  if (streams(command) || plan.forecast.on_disk) {
    stream_phases(command, comm, files, plan, options, outcome);
    outcome.peak_rss_max_bytes = all_reduce_max(comm, peak_rss_bytes());
  } else {
    whole_phases(command, comm, meter, options, outcome);
  }
  outcome.phases = summarise(comm, phases);
  if (command.trace)
    outcome.split_trace = summarise(comm, trace);
  return outcome;
}

Report plan_as_json(const Plan &plan) {
  const Forecast &forecast = plan.forecast;
  return {{"points", plan.points},
          {"on_disk", forecast.on_disk},
          {"axis", axis_name(forecast.axis)},
          {"slabs", forecast.slabs},
          {"path_sites", forecast.path_sites},
          {"memory_bytes", forecast.memory_bytes},
          {"memory_limit_bytes", plan.memory_bytes},
          {"scratch_bytes", forecast.scratch_bytes},
          {"mesh_bytes", forecast.mesh_bytes},
          {"seconds", forecast.seconds}};
}

Report report_of_plan(const TriangulateCommand &command, const Session &session, const Plan &plan) {
  Report report = new_report(session, "triangulate", command.inputs);
  report["forecast"] = plan_as_json(plan);
  return report;
}

Report report_of(const TriangulateCommand &command, const Session &session, const Outcome &outcome) {
  Report report = new_report(session, "triangulate", command.inputs);
  if (command.writes())
    report["output"] = command.output;
  report["kernel"] = kernel_name(command.kernel);
  report["withheld"] = outcome.input.withheld;
  report["other_class"] = outcome.input.other_class;
  report_mesh(report, outcome.mesh);
  if (outcome.validation)
    report["valid"] = outcome.validation->valid;
  report["peak_rss_max_bytes"] = outcome.peak_rss_max_bytes;
  if (outcome.split_trace)
    report["split_trace"] = split_trace_as_json(*outcome.split_trace);
  report["forecast"] = plan_as_json(outcome.plan);
  report["phases"] = phases_as_json(phase_names, outcome.phases);
  return report;
}

void print_outcome(const TriangulateCommand &command, const Session &session, const Outcome &outcome) {
  const DistributedMesh &mesh = outcome.mesh;
  const GlobalIndex sites = mesh.site_count();
  print_points_read(outcome.input);
  print_row("sites", fmt::format("{}, and {} merged", with_separators(sites),
                                 counted(outcome.input.read - sites, "duplicate", "duplicates")));
  print_row("triangles", fmt::format("{} in {} cut along {}", with_separators(mesh.triangle_count()),
                                     counted(mesh.slab_count(), "slab", "slabs"), axis_name(mesh.axis)));
  if (mesh.triangle_count() == 0)
    print_row("notice", no_triangles_reason(sites));
  print_row("hull edges", with_separators(mesh.hull_edges));
  print_row("checksum", checksum_text(mesh.checksum));
  if (outcome.validation)
    print_row("checked", outcome.validation->valid ? "valid, in exact arithmetic" : "NOT VALID");
  else if (!command.writes())
    print_row("checked",
              "counts of every slab, and of all by Euler's relation; the mesh is too large for more");
  print_row("time", times_text(session, outcome.phases));
  print_row("memory", fmt::format("{} on the largest of {}", size_text(outcome.peak_rss_max_bytes),
                                  counted(session.comm.size(), "rank", "ranks")));
  if (command.writes())
    print_row("wrote", files_text(outcome.files));
  if (outcome.split_trace)
    print_split_trace(*outcome.split_trace, sites);
}

ExitCode run_triangulate(const TriangulateCommand &command, const Session &session) {
  const Communicator &comm = session.comm;
  if (command.trace && command.kernel != Kernel::split_path)
    throw Error({ErrorKind::usage, "--trace", "", "only the kernel split-path leaves a trace",
                 "add --kernel split-path"});
  std::vector<std::string> outputs;
  if (command.writes())
    outputs = check_mesh_output(comm, command.output, command.inputs);
  check_report(comm, command.telling.report, command.inputs, outputs);
  std::vector<Stage> stages = usual_shares;
  if (!command.writes())
    stages.back() = {"check", 40};
  ProgressMeter meter(progress_style(comm.is_root(), command.telling), stages);
  meter.begin("read");
  PointReading reading = command.reading;
  reading.progress = progress_into(meter);
  const auto files = open_point_files(comm, command.inputs, reading);
  // Only to check a mesh it is kept whole, and only if it fits: else it is counted as it goes by.
  if (command.room.on_disk && command.writes() && !streams(command))
    throw Error({ErrorKind::usage, "--on-disk", "", "only a .vtkhdf, or none, is made slab by slab",
                 "leave --on-disk away, or let dovetail convert make the other format of a .vtkhdf"});
  const bool can_stream = streams(command) || !command.writes();
  Plan plan =
      plan_run(comm, *files, command.slabs, command.room, command.output, streams(command), command.dry_run);
  if (!command.writes() && (!plan.forecast.fits || command.room.on_disk))
    plan = plan_run(comm, *files, command.slabs, command.room, command.output, true, true);
  if (command.dry_run) {
    meter.finish();
    if (comm.is_root() && !command.telling.quiet)
      print_plan(plan, comm.size(), command.writes());
  }
  require_room(comm, plan, command.output, can_stream);
  if (command.dry_run) {
    write_report(session, report_of_plan(command, session, plan), command.telling.report);
    return success;
  }
  const Outcome outcome = run_phases(command, comm, *files, plan, meter);
  meter.finish();
  write_report(session, report_of(command, session, outcome), command.telling.report);
  if (comm.is_root() && !command.telling.quiet)
    print_outcome(command, session, outcome);
  if (outcome.validation && !outcome.validation->valid) {
    if (comm.is_root())
      print_violations(joined(command.inputs, " "), "the mesh is not valid",
                       "please report this fault of dovetail", *outcome.validation);
    return failure;
  }
  return success;
}

constexpr const char *details =
    R"(Triangulate the points of one file or several: the canonical Delaunay triangulation of
their distinct (x, y), the same for every number of ranks and slabs.

Input:  .las (1.0 to 1.4, uncompressed), .npy (N x 2, N x 3 or more columns of float64 or float32,
        or records with fields x and y), .f64 (x, y, x, y, ... as little-endian doubles),
        .xyz .csv .txt (x y [z ...] in every line, with or without a line of names),
        .node (Triangle's vertices)
Output, by the extension of FILE:
{}
Examples:
  dovetail triangulate survey.las -o survey.vtkhdf
  mpirun -n 4 dovetail triangulate survey.las -o ground.vtkhdf --class 2,9 --duplicates lowest
  mpirun -n 4 dovetail triangulate west.npy east.npy -o both.vtkhdf --slabs 16 --report both.json
  mpirun -n 4 dovetail triangulate stars.npy -o none --progress
  dovetail triangulate stars.npy -o none --kernel split-path --trace
)";

const std::map<std::string, AxisChoice> axis_choices{
    {"auto", AxisChoice::automatic}, {"x", AxisChoice::x}, {"y", AxisChoice::y}};
const std::map<std::string, Kernel> kernels{{"merge", Kernel::merge}, {"split-path", Kernel::split_path}};

} // namespace

Subcommand add_triangulate(CLI::App &app) {
  CLI::App *parser = app.add_subcommand("triangulate", "Make the Delaunay mesh of points");
  parser->footer(fmt::format(details, mesh_outputs));
  const auto command = std::make_shared<TriangulateCommand>();
  parser->add_option("INPUT", command->inputs, "Files of points: " + known_point_extensions())
      ->required()
      ->check(fault_of_name)
      ->option_text("FILE ... (required)");
  parser->add_option("-o,--output", command->output, "Mesh to write; none to check it and write nothing")
      ->required()
      ->option_text("FILE (required)");
  add_class_option(*parser, command->reading.classes);
  add_duplicates_option(*parser, command->slabs.duplicates,
                        "Which of equal points is kept: first in the input, lowest or highest z");
  parser->add_option("--slabs", command->slabs.slabs, "Number of slabs, on all ranks together [by size]")
      ->check(CLI::Range(1, 1 << 24))
      ->option_text("N");
  add_word_option(*parser, "--axis", command->slabs.axis, axis_choices,
                  "Coordinate that the slabs cut; auto looks at a sample")
      ->option_text("auto|x|y [auto]");
  add_word_option(*parser, "--kernel", command->kernel, kernels,
                  "How slabs are triangulated: fast, or as published; the same mesh")
      ->option_text("merge|split-path [merge]");
  parser->add_flag("--trace", command->trace,
                   "Tell what every level of split-path did, in a table and in the report");
  parser->add_flag("--presorted", command->slabs.presorted,
                   "The points ascend by (x, y), or (y, x) with --axis y: checked, not sorted");
  parser
      ->add_option_function<std::string>(
          "--memory",
          [command](const std::string &text) {
            try {
              command->room.memory_bytes = bytes_from_text(text);
            } catch (const std::invalid_argument &problem) {
              throw CLI::ValidationError("--memory", problem.what());
            }
          },
          "Memory for each rank; more points wait on disk [70 % of the node's, shared]")
      ->option_text("4GiB");
  parser
      ->add_option("--scratch", command->room.scratch,
                   "Folder for what does not fit into memory [the output's]")
      ->option_text("FOLDER");
  parser->add_flag("--on-disk", command->room.on_disk,
                   "Let points wait on disk even if they fit into memory (.vtkhdf and none)");
  parser->add_flag("--dry-run", command->dry_run,
                   "Tell what it would take, from sizes and a sample, and whether that is there");
  add_telling_options(*parser, command->telling);
  return {parser, [command](const Session &session) { return run_triangulate(*command, session); }};
}

} // namespace dovetail::cli
