// dovetail verify: is a mesh right, and is it the mesh of these points?
#include "command.hpp"
#include "domain_job.hpp"
#include "domain_verdict.hpp"
#include "options.hpp"
#include "output.hpp"
#include "report.hpp"
#include "text.hpp"
#include "verdict.hpp"

#include "dovetail/comm/phases.hpp"
#include "dovetail/distributed/validate.hpp"
#include "dovetail/io/mesh.hpp"
#include "dovetail/io/points.hpp"
#include "dovetail/mesh/checksum.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <memory>

namespace dovetail::cli {
namespace {

struct VerifyOptions {
  std::string mesh;
  std::string domain; ///< file, or empty
  std::vector<std::string> points;
  PointReading reading;
  Telling telling;
};

void print_check(const char *what, GlobalIndex number, const std::string &how) {
  print_row(what, fmt::format("{}: {}", with_separators(number), how));
}

void print_checks(const VerifyOptions &options, const ValidationReport &found) {
  print_check("triangles", found.triangles, "counter-clockwise, each in its own slab");
  print_check("inner edges", found.inner_edges,
              fmt::format("the same from both sides and locally Delaunay, {} of them between slabs",
                          with_separators(found.border_edges)));
  print_check("hull edges", found.hull_edges, "one convex boundary");
  print_check("sites", found.sites, "finite, distinct, in order, each in some triangle");
  print_check("ghosts", found.ghosts, "equal to the sites they stand for");
  print_check("path edges", found.path_edges, "those that the triangles show");
  print_check("duplicates", found.duplicates, "each of a site");
  if (options.points.empty())
    print_row("input digest", "that of sites and duplicates");
  else
    print_check("input points", found.input_points, "each a site or a duplicate, and none besides");
  print_row("checksum", checksum_text(found.checksum));
}

ValidationReport check(const VerifyOptions &options, const Communicator &comm, ProgressMeter &meter,
                       PhaseLog &phases, SlabSource &mesh) {
  if (options.points.empty()) {
    meter.begin("check");
    return phases.measure("check", [&] { return validate(comm, mesh, progress_into(meter)); });
  }
  meter.begin("read");
  PointReading reading = options.reading;
  reading.progress = progress_into(meter);
  const PointInput input = phases.measure("read", [&] { return read_points(comm, options.points, reading); });
  meter.begin("check");
  return phases.measure("check", [&] { return validate(comm, mesh, input.points, progress_into(meter)); });
}

Report report_of(const VerifyOptions &options, const Session &session, const DistributedMesh &mesh,
                 const ValidationReport &found) {
  std::vector<std::string> inputs{options.mesh};
  inputs.insert(inputs.end(), options.points.begin(), options.points.end());
  Report report = new_report(session, "verify", inputs);
  report["valid"] = found.valid;
  report["slabs"] = mesh.slab_count();
  report["axis"] = axis_name(mesh.axis);
  report["points"] = mesh.digest.points;
  report["sites"] = found.sites;
  report["duplicates"] = found.duplicates;
  report["triangles"] = found.triangles;
  report["hull_edges"] = found.hull_edges;
  report["checksum"] = checksum_text(found.checksum);
  report["ghosts"] = found.ghosts;
  report["inner_edges"] = found.inner_edges;
  report["border_edges"] = found.border_edges;
  report["path_edges"] = found.path_edges;
  report["input_points_compared"] = options.points.empty() ? Report() : Report(found.input_points);
  report["violations"] = found.violation_count;
  report["violations_by_kind"] = Report::object();
  for (std::size_t kind = 0; kind < violation_kinds; ++kind)
    if (found.violations_by_kind[kind] > 0)
      report["violations_by_kind"][std::string(name_of(static_cast<ViolationKind>(kind)))] =
          found.violations_by_kind[kind];
  return report;
}

void print_result(const VerifyOptions &options, const Session &session, const DistributedMesh &mesh,
                  const ValidationReport &found, std::span<const PhaseSummary> times) {
  print_row("read", fmt::format("{}, {} cut along {}", options.mesh,
                                counted(mesh.slab_count(), "slab", "slabs"), axis_name(mesh.axis)));
  if (found.valid) {
    print_checks(options, found);
    if (found.triangles == 0)
      print_row("notice", no_triangles_reason(found.sites));
  }
  print_row("time", times_text(session, times));
  if (found.valid)
    print_row("valid", fmt::format("the canonical Delaunay triangulation of its sites{}",
                                   options.points.empty() ? "" : ", which are the points given"));
  else
    print_row(only_the_points_differ(found) ? "OTHER POINTS" : "NOT VALID",
              counted(found.violation_count, "violation", "violations"));
}

/// A mesh of a domain is checked by one process.
ExitCode verify_as_domain(const VerifyOptions &options, const Session &session, ProgressMeter &meter,
                          PhaseLog &phases) {
  if (!options.points.empty())
    throw Error({ErrorKind::usage, options.mesh, "", "is a mesh of a domain, not of points alone",
                 "compare it with its domain file by --domain"});
  require_one_rank(session, "verify of a mesh of a domain");
  meter.begin("read");
  const DistributedMesh mesh =
      phases.measure("read", [&] { return read_mesh(session.comm, options.mesh, progress_into(meter)); });
  meter.begin("check");
  const DomainVerdict verdict = phases.measure("check", [&] {
    require_sound_layout(session.comm, mesh, options.mesh);
    return verify_domain(mesh, options.domain);
  });
  meter.finish();
  const std::vector<PhaseSummary> times = summarise(session.comm, phases);
  std::vector<std::string> inputs{options.mesh};
  if (!options.domain.empty())
    inputs.push_back(options.domain);
  Report report = new_report(session, "verify", inputs);
  report_verdict(mesh, verdict, report);
  report["phases"] = phases_as_json({}, times);
  write_report(session, std::move(report), options.telling.report);
  if (!options.telling.quiet) {
    print_row("read", options.mesh + ", a mesh of a domain");
    if (verdict.valid())
      print_verdict(mesh, verdict);
    print_row("time", times_text(session, times));
    if (verdict.valid())
      print_row("valid", fmt::format("the constrained Delaunay triangulation of its domain{}",
                                     options.domain.empty() ? "" : ", which is that of the file"));
    else
      print_row(verdict.only_the_domain_differs ? "OTHER DOMAIN" : "NOT VALID",
                counted(std::ssize(verdict.faults), "violation", "violations"));
  }
  if (verdict.valid())
    return success;
  fmt::print(stderr, "dovetail: {}: {}\n", options.mesh,
             verdict.only_the_domain_differs
                 ? "this is not a mesh of the domain given; name the file it was made from, or make it again"
                 : "the mesh is not valid; make it again from its domain");
  for (const std::string &fault : verdict.faults)
    fmt::print(stderr, "  {}\n", fault);
  return failure;
}

ExitCode verify(const VerifyOptions &options, const Session &session) {
  const Communicator &comm = session.comm;
  std::vector<std::string> inputs{options.points};
  inputs.push_back(options.mesh);
  if (!options.domain.empty())
    inputs.push_back(options.domain);
  check_report(comm, options.telling.report, inputs, {});

  ProgressMeter meter(progress_style(comm.is_root(), options.telling), {{"read", 1}, {"check", 30}});
  PhaseLog phases(comm);
  const std::unique_ptr<SlabSource> source =
      phases.measure("read", [&] { return open_mesh(comm, options.mesh); });
  const DistributedMesh &mesh = source->common();
  if (mesh.domain)
    return verify_as_domain(options, session, meter, phases);
  if (!options.domain.empty())
    throw Error({ErrorKind::usage, options.mesh, "", "is a mesh of points, without a domain",
                 "compare it with its points by --points"});
  const ValidationReport found = check(options, comm, meter, phases, *source);
  meter.finish();
  const std::vector<PhaseSummary> times = summarise(comm, phases);
  Report report = report_of(options, session, mesh, found);
  report["phases"] = phases_as_json({}, times);
  write_report(session, std::move(report), options.telling.report);
  if (comm.is_root() && !options.telling.quiet)
    print_result(options, session, mesh, found, times);
  if (found.valid)
    return success;
  if (comm.is_root() && only_the_points_differ(found))
    print_violations(
        options.mesh, "this is not the mesh of the points given",
        "give the files it was made from, in the same order and with the same --class, or make it again",
        found);
  else if (comm.is_root())
    print_violations(options.mesh, "the mesh is not valid", "make it again from its points", found);
  return failure;
}

constexpr const char *details =
    R"(Check in exact arithmetic that a mesh is the canonical Delaunay triangulation of its sites:
orientation of all triangles, adjacency and the Delaunay property of all inner edges, one convex
boundary, the borders between slabs, checksum and input digest; with --points also that the mesh
has every one of these points and no other. Exit code 1, and the first violations, if it is not.
A mesh of a domain is checked to be constrained Delaunay, with every segment there as its chain of
edges, markers along it, and no angle below what it was refined to but between small input angles;
with --domain also that vertices, segments, holes and regions are those of the file.

Examples:
  dovetail verify survey.vtkhdf
  mpirun -n 4 dovetail verify ground.vtkhdf --points survey.las --class 2,9
  mpirun -n 4 dovetail verify both.vtkhdf --points west.npy east.npy --report verdict.json
)";

} // namespace

Subcommand add_verify(CLI::App &app) {
  CLI::App *parser =
      app.add_subcommand("verify", "Check that a mesh is right, and that it is that of its points");
  parser->footer(details);
  const auto options = std::make_shared<VerifyOptions>();
  parser->add_option("MESH", options->mesh, "Mesh to check: .vtkhdf")
      ->required()
      ->check(fault_of_name)
      ->option_text("FILE (required)");
  parser->add_option("--points", options->points, "Points that it was made from, in the same order")
      ->check(fault_of_name)
      ->option_text("FILE ...");
  parser->add_option("--domain", options->domain, "Domain file that it was made from")
      ->check(fault_of_name)
      ->option_text("FILE");
  add_class_option(*parser, options->reading.classes);
  add_telling_options(*parser, options->telling);
  return {parser, [options](const Session &session) { return verify(*options, session); }};
}

} // namespace dovetail::cli
