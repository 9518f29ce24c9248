// dovetail stats: a mesh in figures.
#include "command.hpp"
#include "options.hpp"
#include "output.hpp"
#include "report.hpp"
#include "text.hpp"
#include "verdict.hpp"

#include "dovetail/comm/phases.hpp"
#include "dovetail/distributed/figures.hpp"
#include "dovetail/distributed/validate.hpp"
#include "dovetail/io/mesh.hpp"
#include "dovetail/mesh/checksum.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

namespace dovetail::cli {
namespace {

struct StatsCommand {
  std::string mesh;
  Telling telling;
};

constexpr std::size_t most_bins = 20;
constexpr double widest_bar = 40;

double share_of(GlobalIndex part, GlobalIndex whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

/// "-" instead of the infinities of a histogram of nothing.
std::string range_text(const Histogram &histogram) {
  return histogram.total() > 0 ? fmt::format("{:.6g} to {:.6g}", histogram.lowest, histogram.highest)
                               : "none";
}

/// One line for each bin: bounds, count, share, and a bar as long as the share of the fullest bin.
template <class Label> void print_bins(const Histogram &histogram, Label &&label) {
  const GlobalIndex total = histogram.total();
  if (total == 0)
    return;
  const GlobalIndex most = *std::max_element(histogram.counts.begin(), histogram.counts.end());
  for (std::size_t bin = 0; bin < histogram.counts.size(); ++bin) {
    const GlobalIndex count = histogram.counts[bin];
    const auto bar = static_cast<std::size_t>(std::ceil(widest_bar * share_of(count, most)));
    fmt::print("{:>18} {:>15} {:>6.2f} %{}\n", label(bin), with_separators(count),
               100 * share_of(count, total), bar > 0 ? "  " + std::string(bar, '#') : "");
  }
}

void print_magnitudes(const char *name, const Histogram &histogram, const std::string &sum) {
  print_row(name, fmt::format("{}, {}", range_text(histogram), sum));
  // What a thousandth of all share at each end would otherwise fill the list with empty bins.
  const Histogram shown = condensed(histogram, histogram.total() / 1000, most_bins);
  print_bins(shown, [&](std::size_t bin) {
    return bin == 0 ? fmt::format("below {:g}", shown.bounds[1])
                    : fmt::format("{:g} - {:g}", shown.bounds[bin], shown.bounds[bin + 1]);
  });
}

void print_angles(const char *name, const Histogram &histogram) {
  print_row(name, range_text(histogram) + " degrees");
  print_bins(histogram, [&](std::size_t bin) {
    return fmt::format("{:g} - {:g}", histogram.bounds[bin], histogram.bounds[bin + 1]);
  });
}

void print_degrees(const Histogram &degrees, double mean) {
  print_row("degrees", degrees.total() > 0
                           ? fmt::format("{:g} to {:g}, mean {:.4f}", degrees.lowest, degrees.highest, mean)
                           : "none");
  const Histogram shown = trimmed(degrees);
  print_bins(shown, [&](std::size_t bin) {
    const bool open = shown.bounds[bin + 1] == degrees.bounds.back();
    return fmt::format("{:g}{}", shown.bounds[bin], open ? " or more" : "");
  });
}

std::string paths_text(const std::vector<GlobalIndex> &sites) {
  if (sites.empty())
    return "none";
  const auto [least, most] = std::minmax_element(sites.begin(), sites.end());
  const GlobalIndex all = std::accumulate(sites.begin(), sites.end(), GlobalIndex{0});
  return fmt::format("{}, {} to {} sites, {} together",
                     counted(static_cast<GlobalIndex>(sites.size()), "path", "paths"),
                     with_separators(*least), with_separators(*most), with_separators(all));
}

double mean_of(double sum, GlobalIndex count) { return count > 0 ? sum / static_cast<double>(count) : 0; }

/// Edges have two ends.
double mean_degree(const DistributedMesh &mesh, const MeshFigures &figures) {
  return mean_of(2 * static_cast<double>(figures.edge_lengths.total()), mesh.site_count());
}

void print_figures(const StatsCommand &command, const DistributedMesh &mesh, const MeshFigures &figures) {
  const GlobalIndex triangles = mesh.triangle_count();
  const GlobalIndex edges = figures.edge_lengths.total();
  print_row("mesh", fmt::format("{}, {} cut along {}", command.mesh,
                                counted(mesh.slab_count(), "slab", "slabs"), axis_name(mesh.axis)));
  print_row("sites", with_separators(mesh.site_count()));
  print_row("duplicates",
            figures.duplicates == 0
                ? "0"
                : fmt::format("{} of {}, {} at most of one", with_separators(figures.duplicates),
                              counted(figures.repeated_sites, "site", "sites"),
                              with_separators(figures.most_duplicates)));
  print_row("triangles", with_separators(triangles));
  print_row("edges", with_separators(edges));
  print_row(mesh.domain ? "boundary" : "convex hull",
            fmt::format("{}, length {:.9g}, area {:.9g}", counted(figures.hull_edges, "edge", "edges"),
                        figures.hull_length, figures.area));
  print_row("split paths", paths_text(figures.path_sites));
  print_angles("angles", figures.angles);
  print_angles("smallest angles", figures.smallest_angles);
  print_magnitudes("areas", figures.areas, fmt::format("mean {:.6g}", mean_of(figures.area, triangles)));
  print_magnitudes("edge lengths", figures.edge_lengths,
                   fmt::format("mean {:.6g}", mean_of(figures.edge_length, edges)));
  print_degrees(figures.degrees, mean_degree(mesh, figures));
}

Report report_of(const StatsCommand &command, const Session &session, const DistributedMesh &mesh,
                 const MeshFigures &figures) {
  Report report = new_report(session, "stats", std::vector{command.mesh});
  report["slabs"] = mesh.slab_count();
  report["axis"] = axis_name(mesh.axis);
  report["points"] = mesh.digest.points;
  report["sites"] = mesh.site_count();
  report["duplicates"] = figures.duplicates;
  report["triangles"] = mesh.triangle_count();
  report["hull_edges"] = figures.hull_edges;
  report["checksum"] = checksum_text(mesh.checksum);
  const auto &paths = figures.path_sites;
  report["path_sites"] = std::accumulate(paths.begin(), paths.end(), GlobalIndex{0});
  report["longest_path"] = paths.empty() ? 0 : *std::max_element(paths.begin(), paths.end());
  report["repeated_sites"] = figures.repeated_sites;
  report["most_duplicates"] = figures.most_duplicates;
  report["hull_length"] = figures.hull_length;
  report["area"] = figures.area;
  report["edges"] = figures.edge_lengths.total();
  report["edge_length"] = figures.edge_length;
  report["mean_degree"] = mean_degree(mesh, figures);
  report["path_lengths"] = paths;
  report["angles"] = histogram_as_json(figures.angles);
  report["smallest_angles"] = histogram_as_json(figures.smallest_angles);
  report["areas"] = histogram_as_json(trimmed(figures.areas));
  report["edge_lengths"] = histogram_as_json(trimmed(figures.edge_lengths));
  report["degrees"] = histogram_as_json(figures.degrees);
  return report;
}

ExitCode run_stats(const StatsCommand &command, const Session &session) {
  const Communicator &comm = session.comm;
  check_report(comm, command.telling.report, std::vector{command.mesh}, {});
  ProgressMeter meter(progress_style(comm.is_root(), command.telling), {{"read", 3}, {"measure", 2}});
  PhaseLog phases(comm);
  meter.begin("read");
  const DistributedMesh mesh =
      phases.measure("read", [&] { return read_mesh(comm, command.mesh, progress_into(meter)); });
  meter.begin("measure");
  const MeshFigures figures = phases.measure("measure", [&] {
    require_sound_layout(comm, mesh, command.mesh);
    return measure(comm, mesh, progress_into(meter));
  });
  meter.finish();
  Report report = report_of(command, session, mesh, figures);
  report["phases"] = phases_as_json({}, summarise(comm, phases));
  write_report(session, std::move(report), command.telling.report);
  if (comm.is_root() && !command.telling.quiet)
    print_figures(command, mesh, figures);
  return success;
}

constexpr const char *details =
    R"(Angles, areas, edge lengths and degrees as histograms; convex hull, split paths, duplicates.
Every edge counts once, every triangle with its three angles, and the numbers are the same for every
number of ranks. The report has them as JSON: counts[i] values are at least bounds[i] and below
bounds[i + 1].

Examples:
  dovetail stats survey.vtkhdf
  mpirun -n 4 dovetail stats stars.vtkhdf --report stars.json --quiet
)";

} // namespace

Subcommand add_stats(CLI::App &app) {
  CLI::App *parser = app.add_subcommand("stats", "Say how angles, areas, edges and degrees are distributed");
  parser->footer(details);
  const auto command = std::make_shared<StatsCommand>();
  parser->add_option("MESH", command->mesh, "Mesh to measure: .vtkhdf")
      ->required()
      ->check(fault_of_name)
      ->option_text("FILE (required)");
  add_telling_options(*parser, command->telling);
  return {parser, [command](const Session &session) { return run_stats(*command, session); }};
}

} // namespace dovetail::cli
