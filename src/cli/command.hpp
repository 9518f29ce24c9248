/// The subcommands of `dovetail`: how each adds itself to the command line, and what it is given to run.
#pragma once

#include "dovetail/comm/communicator.hpp"

#include <CLI/CLI.hpp>

#include <chrono>
#include <functional>
#include <string>
#include <vector>

namespace dovetail::cli {

/// What a run knows of itself. The same on all ranks, apart from the start.
struct Session {
  const Communicator &comm;
  std::vector<std::string> command_line;
  std::chrono::steady_clock::time_point start; ///< when main began
  std::chrono::steady_clock::time_point ready; ///< when MPI had been started
};

enum ExitCode : int {
  success = 0,
  failure = 1,     ///< an input, output or resource did not suffice, or a mesh is not valid
  wrong_usage = 2, ///< the command line makes no sense
};

/// A subcommand's options live in `run`, which is Collective: returns the exit code or throws an Error, alike
/// on all ranks.
struct Subcommand {
  CLI::App *parser;
  std::function<ExitCode(const Session &)> run;
};

Subcommand add_triangulate(CLI::App &app);
Subcommand add_generate(CLI::App &app);
Subcommand add_verify(CLI::App &app);
Subcommand add_info(CLI::App &app);
Subcommand add_convert(CLI::App &app);
Subcommand add_stats(CLI::App &app);
Subcommand add_render(CLI::App &app);
Subcommand add_constrain(CLI::App &app);
Subcommand add_refine(CLI::App &app);
Subcommand add_insert(CLI::App &app);

} // namespace dovetail::cli
