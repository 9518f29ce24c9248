// dovetail refine: from a domain, points or a stored mesh of a domain to well-shaped triangles.
#include "command.hpp"
#include "domain_job.hpp"
#include "options.hpp"
#include "output.hpp"
#include "report.hpp"
#include "text.hpp"

#include "dovetail/base/error.hpp"
#include "dovetail/comm/phases.hpp"
#include "dovetail/distributed/figures.hpp"
#include "dovetail/distributed/validate.hpp"
#include "dovetail/io/domain.hpp"
#include "dovetail/io/mesh.hpp"
#include "dovetail/io/points.hpp"
#include "dovetail/mesh/feature_size.hpp"
#include "dovetail/mesh/refine.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <array>
#include <memory>
#include <new>

namespace dovetail::cli {
namespace {

enum class Boundary : std::uint8_t { hull, box };
const std::map<std::string, Boundary> boundaries{{"hull", Boundary::hull}, {"box", Boundary::box}};

struct RefineCommand {
  std::string input;
  std::string output;
  DomainOptions domain;
  Boundary boundary = Boundary::hull;
  RefineOptions options;
  Telling telling;
  bool is_mesh() const { return extension_of(input) == ".vtkhdf"; }
};

const std::vector<std::string> phase_names{"read", "constrain", "refine", "measure", "write"};

constexpr std::string_view name_of(LeftReason reason) {
  constexpr std::array<std::string_view, left_reasons> names{"small input angle", "precision", "min edge",
                                                             "max points", "locked"};
  return names[static_cast<std::size_t>(reason)];
}

/// The integral over the local feature size takes a few microseconds a look-up.
constexpr GlobalIndex most_triangles_measured = 20000;

/// A mesh that is to be refined.
struct Start {
  DomainJob job; ///< `planar` without repairs for a stored mesh
  DomainMesh mesh;
  DomainRecord record;
};

DomainJob job_of_points(const RefineCommand &command, const Communicator &comm, const Progress &progress) {
  PointReading reading;
  reading.progress = progress;
  const PointInput input = read_points(comm, std::span(&command.input, 1), reading);
  DomainJob job;
  job.input = command.input;
  SegmentSet set;
  set.vertices = input.points.points;
  for (const Attribute &attribute : input.points.attributes)
    job.notices.push_back(fmt::format("attribute {} left out: new points have none", attribute.name));
  if (command.boundary == Boundary::box && !set.vertices.empty()) {
    Point low = set.vertices.front(), high = low;
    for (const Point p : set.vertices) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    const auto first = static_cast<LocalIndex>(set.vertices.size());
    set.vertices.insert(set.vertices.end(), {low, {high.x, low.y}, high, {low.x, high.y}});
    for (LocalIndex i = 0; i < 4; ++i)
      set.segments.push_back({first + i, first + (i + 1) % 4, 1});
  }
  job.given_vertices = std::ssize(set.vertices);
  job.given_segments = std::ssize(set.segments);
  job.planar = planarise(set);
  for (std::size_t i = 0; i < set.vertices.size(); ++i)
    if (const LocalIndex v = job.planar.vertex_of_input[i];
        static_cast<std::size_t>(v) == job.vertices.input_index.size())
      job.vertices.input_index.push_back(static_cast<GlobalIndex>(i));
    else
      job.vertices.duplicates.push_back({static_cast<GlobalIndex>(i), v});
  return job;
}

/// What was given is what is there.
DomainJob job_of_mesh(const RefineCommand &command, const DistributedMesh &stored) {
  DomainJob job;
  job.input = command.input;
  const PointTable &table = stored.slabs.front().vertices;
  job.vertices.input_index = table.input_index;
  for (const Attribute &attribute : table.attributes)
    if (attribute.name != "marker")
      job.vertices.attributes.push_back(attribute);
  job.vertices.duplicates = stored.duplicates;
  job.given_vertices = record_of(stored).given_vertices;
  job.given_segments = std::ssize(record_of(stored).segments);
  return job;
}

Start start_from_mesh(const RefineCommand &command, const Communicator &comm, const Progress &progress) {
  DistributedMesh stored = read_mesh(comm, command.input, progress);
  require_sound_layout(comm, stored, command.input);
  if (!stored.domain)
    throw Error({ErrorKind::input, command.input, "", "is a mesh of points, without a domain",
                 "give the points themselves to refine, with --boundary hull or box"});
  return {job_of_mesh(command, stored), domain_of_slab(stored), *stored.domain};
}

Start start(const RefineCommand &command, const Session &session, PhaseLog &phases, ProgressMeter &meter) {
  const Progress progress = progress_into(meter);
  if (command.is_mesh())
    return phases.measure("read", [&] { return start_from_mesh(command, session.comm, progress); });
  const bool is_domain = is_domain_file(command.input);
  const bool is_laz = extension_of(command.input) == ".laz"; // of which the reader of points has more to say
  if (!is_domain && !is_laz && !point_format_of(command.input))
    throw Error({ErrorKind::usage, command.input, "",
                 "its extension is not that of a domain, mesh or point file",
                 fmt::format("name a domain ({}), a mesh (.vtkhdf), or points ({})", domain_extensions,
                             known_point_extensions())});
  Start result;
  result.job = phases.measure("read", [&] {
    return is_domain ? domain_of_file(command.input, command.domain)
                     : job_of_points(command, session.comm, progress);
  });
  meter.begin("constrain");
  phases.measure("constrain", [&] {
    const bool whole_hull = is_domain ? command.domain.convex : command.boundary == Boundary::hull;
    Constrained constrained =
        constrain_domain(result.job, {.outline = whole_hull ? Outline::convex_hull : Outline::segments});
    result.record = record_of(result.job, constrained);
    result.mesh = std::move(constrained.mesh);
  });
  return result;
}

/// Vertices of some triangle, given and without segments: features by themselves.
std::vector<LocalIndex> lone_vertices(const DomainMesh &mesh, const DomainRecord &record,
                                      std::span<const GlobalIndex> input_index) {
  enum Use : std::uint8_t { unused, used, on_segment };
  std::vector<Use> use(mesh.vertices.size(), unused);
  for (const LocalIndex corner : mesh.triangles.corners)
    use[static_cast<std::size_t>(corner)] = used;
  for (const Segment &segment : record.segments)
    for (const LocalIndex end : {segment.from, segment.to})
      use[static_cast<std::size_t>(end)] = on_segment;
  std::vector<LocalIndex> found;
  for (std::size_t v = 0; v < input_index.size(); ++v)
    if (use[v] == used && input_index[v] < record.given_vertices)
      found.push_back(static_cast<LocalIndex>(v));
  return found;
}

/// What a finished run has to tell.
struct Outcome {
  DistributedMesh mesh;
  Refined refined; ///< its mesh is gone
  MeshFigures figures;
  std::optional<double> feature_integral;
};

Outcome refine_start(const RefineCommand &command, Start start, const Progress &progress) {
  RefineOptions options = command.options;
  options.progress = progress;
  for (const RegionSeed &region : start.record.regions)
    options.max_area_of_region.push_back(region.max_area);
  if (options.growth > 0)
    options.lone_vertices = lone_vertices(start.mesh, start.record, start.job.vertices.input_index);
  Outcome outcome;
  try {
    outcome.refined = refine(std::move(start.mesh), start.record.segments, options);
  } catch (const Error &error) { // of the kernel, which knows no file
    Problem problem = error.problem();
    problem.place = problem.subject;
    problem.subject = command.input;
    throw Error(problem);
  } catch (const std::bad_alloc &) {
    throw Error({ErrorKind::resource, command.input, "", "its triangles take more memory than there is",
                 "allow larger ones (--max-area, --min-edge), or no more than fit (--max-points)"});
  }
  start.record.min_angle = options.min_angle;
  start.record.left_triangles.clear();
  for (const LeftTriangle &left : outcome.refined.left_triangles)
    if (left.reason != LeftReason::small_input_angle && left.angle < options.min_angle)
      start.record.left_triangles.push_back(left.triangle);
  number_new_vertices(outcome.refined.mesh.vertices.size(), start.job.vertices);
  outcome.mesh =
      slab_of_domain(std::move(outcome.refined.mesh), std::move(start.record), std::move(start.job.vertices));
  return outcome;
}

void measure_outcome(const Communicator &comm, const Progress &progress, Outcome &outcome) {
  outcome.figures = measure(comm, outcome.mesh, part_of_stage(progress, 0, 0.2));
  if (outcome.mesh.triangle_count() > most_triangles_measured)
    return;
  const DomainMesh mesh = domain_of_slab(outcome.mesh);
  const DomainRecord &record = record_of(outcome.mesh);
  const FeatureSize size(mesh.vertices, record.segments,
                         lone_vertices(mesh, record, outcome.mesh.slabs.front().vertices.input_index));
  outcome.feature_integral = integrate_feature_density(mesh, size, part_of_stage(progress, 0.2, 1));
}

std::string left_text(const Refined &refined) {
  std::array<GlobalIndex, left_reasons> counts{};
  for (const LeftTriangle &left : refined.left_triangles)
    ++counts[static_cast<std::size_t>(left.reason)];
  std::vector<std::string> parts;
  for (std::size_t reason = 0; reason < left_reasons; ++reason)
    if (counts[reason] > 0)
      parts.push_back(fmt::format("{} ({})", counts[reason], name_of(static_cast<LeftReason>(reason))));
  return parts.empty() ? "0" : joined(parts, ", ");
}

void print_result(const RefineCommand &command, const DomainJob &job, const Outcome &outcome,
                  std::span<const std::string> files) {
  const MeshFigures &figures = outcome.figures;
  print_row("read", fmt::format("{} and {} from {}", counted(job.given_vertices, "vertex", "vertices"),
                                counted(job.given_segments, "segment", "segments"), command.input));
  if (!command.is_mesh())
    print_row("repairs", repairs_text(job));
  for (const std::string &notice : job.notices)
    print_row("notice", notice);
  print_row("Steiner points",
            fmt::format("{} on segments, {} inside", with_separators(outcome.refined.points_on_segments),
                        with_separators(outcome.refined.points_inside)));
  print_row("vertices", with_separators(outcome.mesh.site_count()));
  print_row("triangles", with_separators(outcome.mesh.triangle_count()));
  print_row("smallest angle", fmt::format("{:.4f} degrees, bound {:g}", figures.smallest_angles.lowest,
                                          command.options.min_angle));
  print_row("left triangles", left_text(outcome.refined));
  if (!outcome.refined.left_subsegments.empty())
    print_row("left subsegments", with_separators(std::ssize(outcome.refined.left_subsegments)));
  if (outcome.feature_integral)
    print_row("vertices per lfs",
              fmt::format("{:.4g}: vertices over the integral of 1 / lfs^2, {:.6g}",
                          static_cast<double>(outcome.mesh.site_count()) / *outcome.feature_integral,
                          *outcome.feature_integral));
  print_row("wrote", files_text(files));
}

Report left_as_json(const Refined &refined) {
  Report list = Report::array();
  for (const LeftTriangle &left : refined.left_triangles)
    list.push_back({{"triangle", left.triangle},
                    {"x", left.place.x},
                    {"y", left.place.y},
                    {"reason", name_of(left.reason)},
                    {"angle", left.angle},
                    {"area", left.area}});
  return list;
}

Report report_of(const RefineCommand &command, const Session &session, const DomainJob &job,
                 const Outcome &outcome) {
  Report report = new_report(session, "refine", std::vector{command.input});
  report["output"] = command.output;
  report_domain(outcome.mesh, report);
  report["repairs"] = command.is_mesh() ? Report() : repairs_as_json(job);
  report["notices"] = job.notices;
  report["min_angle"] = command.options.min_angle;
  report["steiner_on_segments"] = outcome.refined.points_on_segments;
  report["steiner_inside"] = outcome.refined.points_inside;
  report["smallest_angle"] = outcome.figures.smallest_angles.lowest;
  report["area"] = outcome.figures.area;
  report["angles"] = histogram_as_json(outcome.figures.angles);
  report["smallest_angles"] = histogram_as_json(outcome.figures.smallest_angles);
  report["areas"] = histogram_as_json(trimmed(outcome.figures.areas));
  report["feature_integral"] = outcome.feature_integral ? Report(*outcome.feature_integral) : Report();
  report["vertices_per_feature_integral"] =
      outcome.feature_integral
          ? Report(static_cast<double>(outcome.mesh.site_count()) / *outcome.feature_integral)
          : Report();
  report["left_triangles"] = left_as_json(outcome.refined);
  report["left_subsegments"] = std::ssize(outcome.refined.left_subsegments);
  return report;
}

ExitCode run_refine(const RefineCommand &command, const Session &session) {
  const Communicator &comm = session.comm;
  require_one_rank(session, "refine");
  const std::array inputs{command.input};
  const auto outputs = check_mesh_output(comm, command.output, inputs);
  check_report(comm, command.telling.report, inputs, outputs);
  ProgressMeter meter(progress_style(comm.is_root(), command.telling),
                      {{"read", 1}, {"constrain", 1}, {"refine", 4}, {"measure", 2}, {"write", 2}});
  const Progress progress = progress_into(meter);
  PhaseLog phases(comm);
  meter.begin("read");
  Start started = start(command, session, phases, meter);
  DomainJob job = started.job;
  meter.begin("refine");
  Outcome outcome =
      phases.measure("refine", [&] { return refine_start(command, std::move(started), progress); });
  meter.begin("measure");
  phases.measure("measure", [&] { measure_outcome(comm, progress, outcome); });
  meter.begin("write");
  const auto files = phases.measure(
      "write", [&] { return write_mesh(comm, outcome.mesh, command.output, {.progress = progress}); });
  meter.finish();
  Report report = report_of(command, session, job, outcome);
  report["phases"] = phases_as_json(phase_names, summarise(comm, phases));
  write_report(session, std::move(report), command.telling.report);
  if (comm.is_root() && !command.telling.quiet)
    print_result(command, job, outcome, files);
  return success;
}

void add_refine_options(CLI::App &parser, RefineCommand &command) {
  RefineOptions &options = command.options;
  parser
      .add_option("--min-angle", options.min_angle,
                  "No angle below this but where segments meet at small angles; 0: any angle")
      ->check(CLI::Range(0.0, 33.0))
      ->option_text("DEGREES [26.45]");
  parser.add_option("--max-area", options.max_area, "No triangle larger than this")
      ->check(CLI::PositiveNumber)
      ->option_text("AREA");
  parser
      .add_option("--growth", options.growth,
                  "Size field: edges as long as the boundary's, plus this per unit of distance")
      ->check(CLI::PositiveNumber)
      ->option_text("RATE");
  parser.add_option("--min-edge", options.min_edge, "No new point nearer than this to another")
      ->check(CLI::PositiveNumber)
      ->option_text("LENGTH");
  parser
      .add_option_function<std::string>(
          "--max-points",
          [&options](const std::string &text) {
            try {
              options.max_points = static_cast<LocalIndex>(
                  std::min<GlobalIndex>(count_from_text(text), std::numeric_limits<LocalIndex>::max()));
            } catch (const std::invalid_argument &reason) {
              throw CLI::ValidationError("--max-points", reason.what());
            }
          },
          "No more vertices than this, those of the input included")
      ->option_text("N");
  add_word_option(parser, "--boundary", command.boundary, boundaries,
                  "What bounds a set of points: its convex hull or its box")
      ->option_text("hull|box [hull]");
}

constexpr const char *details =
    R"(Steiner points are added until no angle is below the bound and no triangle above the limits. What
cannot be improved, near small angles between segments above all, is counted, and listed in the
report. The input is a domain (.poly, .geojson, .json), points of any kind, or a mesh of a domain
(.vtkhdf), which is refined further. Areas that a .poly gives for its regions hold there.
Runs on one rank. The output is one of
{}

Examples:
  dovetail refine coast.poly -o coast.vtkhdf
  dovetail refine part.poly -o part.msh --min-angle 30 --max-area 0.01
  dovetail refine wells.csv -o wells.vtkhdf --boundary box --growth 0.2
)";

} // namespace

Subcommand add_refine(CLI::App &app) {
  CLI::App *parser = app.add_subcommand("refine", "Fill a domain with well-shaped triangles");
  parser->footer(fmt::format(details, mesh_outputs));
  const auto command = std::make_shared<RefineCommand>();
  parser
      ->add_option("INPUT", command->input,
                   fmt::format("Domain ({}), mesh of one (.vtkhdf), or points", domain_extensions))
      ->required()
      ->check(fault_of_name)
      ->option_text("FILE (required)");
  parser->add_option("-o,--output", command->output, "Mesh to write")
      ->required()
      ->option_text("FILE (required)");
  add_refine_options(*parser, *command);
  add_domain_options(*parser, command->domain);
  add_telling_options(*parser, command->telling);
  return {parser, [command](const Session &session) { return run_refine(*command, session); }};
}

} // namespace dovetail::cli
