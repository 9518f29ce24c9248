/// The record of a run as JSON, for programs: the same keys for every subcommand.
#pragma once

#include "command.hpp"

#include "dovetail/comm/phases.hpp"
#include "dovetail/distributed/mesh.hpp"
#include "dovetail/mesh/histogram.hpp"

#include <nlohmann/json.hpp>

#include <span>
#include <string>
#include <vector>

namespace dovetail::cli {

using Report = nlohmann::ordered_json;

/// A report with what is known before any work; every other value is null until it is set, and stays null
/// where it does not apply.
Report new_report(const Session &session, const std::string &subcommand, std::span<const std::string> inputs);

/// What every mesh says of itself.
void report_counts(Report &report, const DistributedMesh &mesh);

/// What the mesh of points says that was just made: also its points, and how they were shared out.
void report_mesh(Report &report, const DistributedMesh &mesh);

/// The phases in the order of `names`. A phase that was not run has null for every number; one that is not
/// among the names follows at the end.
Report phases_as_json(std::span<const std::string> names, std::span<const PhaseSummary> phases);

/// counts[i] values are at least bounds[i] and below bounds[i + 1].
Report histogram_as_json(const Histogram &histogram);

/// The phases for people, such as "Time: 12.3 s (read 0.5, sort 3.2, write 1.1)": the whole since the start
/// of the program, each phase on its slowest rank.
std::string times_text(const Session &session, std::span<const PhaseSummary> phases);

/// Collective. Fills in `wall_s` (since the start of the program) and, if it is null, `peak_rss_max_bytes`,
/// and writes the report to `path` as write_text_file does. Nothing at all if `path` is empty.
void write_report(const Session &session, Report report, const std::string &path);

} // namespace dovetail::cli
