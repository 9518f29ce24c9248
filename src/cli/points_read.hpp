/// Points that a command reads: an option for equal ones, and what is said of them. Local; the latter for the
/// root.
#pragma once

#include "dovetail/distributed/slabs.hpp"
#include "dovetail/io/points.hpp"

#include <CLI/CLI.hpp>

#include <string>

namespace dovetail::cli {

/// Adds `--duplicates first`.
void add_duplicates_option(CLI::App &parser, DuplicateRule &rule, const std::string &description);

/// How many points from where, and what was skipped or is absent.
void print_points_read(const PointInput &input);

/// What points get that have no attribute `name` where others have it: "z = 0" or "NaN".
const char *value_of_absent(const std::string &name);

} // namespace dovetail::cli
