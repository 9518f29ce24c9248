#include "report.hpp"

#include "output.hpp"
#include "text.hpp"
#include "verdict.hpp"
#include "version.hpp"

#include "dovetail/comm/collectives.hpp"
#include "dovetail/io/libraries.hpp"
#include "dovetail/io/mesh.hpp"
#include "dovetail/mesh/checksum.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dovetail::cli {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Report phase_as_json(const std::string &name, const PhaseSummary *phase) {
  Report json;
  json["name"] = name;
  for (const char *key : {"wall_max_s", "wall_mean_s", "cpu_max_s", "cpu_sum_s", "bytes_sent",
                          "messages_sent", "peak_rss_max_bytes"})
    json[key] = nullptr;
  if (phase == nullptr)
    return json;
  json["wall_max_s"] = phase->wall_max_s;
  json["wall_mean_s"] = phase->wall_mean_s;
  json["cpu_max_s"] = phase->cpu_max_s;
  json["cpu_sum_s"] = phase->cpu_sum_s;
  json["bytes_sent"] = phase->bytes_sent;
  json["messages_sent"] = phase->messages_sent;
  json["peak_rss_max_bytes"] = phase->peak_rss_max_bytes;
  return json;
}

/// Collective. On how many machines the ranks run, where a machine is what shares memory.
int hosts_of(const Communicator &comm) {
  MPI_Comm host = MPI_COMM_NULL;
  MPI_Comm_split_type(comm.raw(), MPI_COMM_TYPE_SHARED, comm.rank(), MPI_INFO_NULL, &host);
  int rank_on_host = 0;
  MPI_Comm_rank(host, &rank_on_host);
  MPI_Comm_free(&host);
  return all_reduce_sum(comm, rank_on_host == 0 ? 1 : 0);
}

} // namespace

Report new_report(const Session &session, const std::string &subcommand,
                  std::span<const std::string> inputs) {
  const LibraryVersions libraries = library_versions();
  Report report;
  report["program"] = "dovetail";
  report["version"] = project_version();
  report["libraries"] = {{"mpi", libraries.mpi}, {"hdf5", libraries.hdf5}};
  report["mesh_format"] = mesh_format_version;
  report["subcommand"] = subcommand;
  report["command_line"] = session.command_line;
  report["inputs"] = inputs;
  report["output"] = nullptr;
  report["ranks"] = session.comm.size();
  report["hosts"] = nullptr;
  for (const char *key : {"slabs",
                          "axis",
                          "kernel",
                          "points",
                          "withheld",
                          "other_class",
                          "sites",
                          "duplicates",
                          "triangles",
                          "hull_edges",
                          "checksum",
                          "valid",
                          "wall_s",
                          "peak_rss_max_bytes",
                          "own_sites_max",
                          "path_sites_max",
                          "candidate_sites_max",
                          "imbalance",
                          "path_sites",
                          "longest_path",
                          "ghosts",
                          "split_trace",
                          "phases"})
    report[key] = nullptr;
  return report;
}

void report_counts(Report &report, const DistributedMesh &mesh) {
  report["slabs"] = mesh.slab_count();
  report["axis"] = axis_name(mesh.axis);
  report["sites"] = mesh.site_count();
  report["triangles"] = mesh.triangle_count();
  report["hull_edges"] = mesh.hull_edges;
  report["checksum"] = checksum_text(mesh.checksum);
}

void report_mesh(Report &report, const DistributedMesh &mesh) {
  const MeshStatistics &statistics = mesh.statistics;
  report_counts(report, mesh);
  report["points"] = mesh.digest.points;
  report["duplicates"] = mesh.digest.points - mesh.site_count();
  report["own_sites_max"] = statistics.own_sites_max;
  report["path_sites_max"] = statistics.path_sites_max;
  report["candidate_sites_max"] = statistics.candidate_sites_max;
  report["imbalance"] = statistics.slab_imbalance(mesh.site_count(), mesh.slab_count());
  report["path_sites"] = statistics.path_sites;
  report["longest_path"] = statistics.longest_path;
  report["ghosts"] = statistics.ghosts;
}

Report phases_as_json(std::span<const std::string> names, std::span<const PhaseSummary> phases) {
  Report all = Report::array();
  for (const std::string &name : names) {
    const auto phase =
        std::find_if(phases.begin(), phases.end(), [&](const PhaseSummary &p) { return p.name == name; });
    all.push_back(phase_as_json(name, phase == phases.end() ? nullptr : &*phase));
  }
  for (const PhaseSummary &phase : phases)
    if (std::find(names.begin(), names.end(), phase.name) == names.end())
      all.push_back(phase_as_json(phase.name, &phase));
  return all;
}

Report histogram_as_json(const Histogram &histogram) {
  Report json;
  const GlobalIndex total = histogram.total();
  json["count"] = total;
  json["lowest"] = total > 0 ? Report(histogram.lowest) : Report();
  json["highest"] = total > 0 ? Report(histogram.highest) : Report();
  json["bounds"] = histogram.bounds;
  json["counts"] = histogram.counts;
  return json;
}

std::string times_text(const Session &session, std::span<const PhaseSummary> phases) {
  const std::chrono::duration<double> startup = session.ready - session.start;
  std::vector<std::string> parts{"start " + duration_text(startup.count())};
  for (const PhaseSummary &phase : phases)
    parts.push_back(phase.name + " " + duration_text(phase.wall_max_s));
  return fmt::format("{}: {}", duration_text(seconds_since(session.start)), joined(parts, ", "));
}

void write_report(const Session &session, Report report, const std::string &path) {
  if (path.empty())
    return;
  report["wall_s"] = seconds_since(session.start);
  report["hosts"] = hosts_of(session.comm);
  const std::int64_t peak = all_reduce_max(session.comm, peak_rss_bytes());
  if (report["peak_rss_max_bytes"].is_null())
    report["peak_rss_max_bytes"] = peak;
  // File names need not be UTF-8; a report that cannot hold one is still better than none.
  write_text_file(session.comm, path,
                  report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

} // namespace dovetail::cli
