// The command `dovetail`. All ranks parse the same command line, run the same subcommand and leave with the
// same exit code; rank 0 alone prints.
#include "command.hpp"
#include "version.hpp"

#include "dovetail/base/error.hpp"
#include "dovetail/comm/collectives.hpp"

#include <CLI/CLI.hpp>
#include <boost/mpi/environment.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <sstream>

namespace dovetail::cli {
namespace {

constexpr const char *description =
    "Exact two-dimensional Delaunay triangulation, on one process or on many with mpirun.\n"
    "The mesh is the same for every number of processes.";
constexpr const char *examples = R"(Examples:
  dovetail generate kuzmin -n 1e6 --seed 1 -o stars.npy
  mpirun -n 4 dovetail triangulate stars.npy -o stars.vtkhdf
  mpirun -n 4 dovetail verify stars.vtkhdf --points stars.npy
  dovetail info stars.vtkhdf
Each command has its own help, such as dovetail triangulate --help.
)";

/// A wrong command line, help and version end here, before any work, and alike on all ranks.
ExitCode explain(const CLI::App &app, const CLI::ParseError &error, const Communicator &world) {
  if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) {
    std::ostringstream text;
    app.exit(error, text, text);
    if (world.is_root())
      fmt::print("{}", text.str());
    return success;
  }
  std::string command = "dovetail";
  for (const CLI::App *chosen : app.get_subcommands())
    command += " " + chosen->get_name();
  std::string problem = error.what();
  if (problem.starts_with("A ") || problem.starts_with("The "))
    problem.front() = static_cast<char>(problem.front() - 'A' + 'a');
  if (world.is_root())
    fmt::print(stderr, "dovetail: {}; see {} --help\n", problem, command);
  return wrong_usage;
}

/// CLI11 would call a misspelt command an unexpected argument.
void refuse_unknown_command(const CLI::App &app, const std::vector<std::string> &command_line) {
  if (command_line.size() < 2 || command_line[1].starts_with('-'))
    return;
  const auto known = app.get_subcommands([](const CLI::App *) { return true; });
  if (std::none_of(known.begin(), known.end(),
                   [&](const CLI::App *command) { return command->check_name(command_line[1]); }))
    throw CLI::ValidationError(fmt::format("there is no subcommand '{}'", command_line[1]));
}

ExitCode run(int argc, char **argv, const Session &session) {
  CLI::App app(description, "dovetail");
  app.footer(examples);
  app.set_version_flag("--version", version_text, "Print the versions of dovetail and its libraries");
  app.require_subcommand(1);
  const std::vector<Subcommand> subcommands{add_triangulate(app), add_generate(app), add_verify(app),
                                            add_info(app)};
  try {
    refuse_unknown_command(app, session.command_line);
    app.parse(argc, argv);
  } catch (const CLI::ParseError &error) {
    return explain(app, error, session.comm);
  }
  for (const Subcommand &subcommand : subcommands)
    if (subcommand.parser->parsed())
      return subcommand.run(session);
  return wrong_usage;
}

/// Runs the command and tells an Error, which all ranks have alike.
ExitCode run_and_report(int argc, char **argv, const Session &session) {
  try {
    return run(argc, argv, session);
  } catch (const Error &error) {
    if (session.comm.is_root())
      fmt::print(stderr, "dovetail: {}\n", error.what());
    return error.kind() == ErrorKind::usage ? wrong_usage : failure;
  }
}

/// What was printed may not have arrived, say on a full disk. Collective.
ExitCode flush_output(const Session &session, ExitCode code) {
  bool lost = std::fflush(stdout) != 0 || std::ferror(stdout) != 0;
  if (lost && session.comm.is_root())
    fmt::print(stderr, "dovetail: standard output: cannot be written ({})\n", std::strerror(errno));
  lost = any_of_ranks(session.comm, lost);
  return lost && code == success ? failure : code;
}

} // namespace
} // namespace dovetail::cli

int main(int argc, char **argv) {
  using namespace dovetail;
  const auto start = std::chrono::steady_clock::now();
  // Writes to a full disk or a closed pipe shall fail with an error that can be told, not kill the process.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  // A thread of its own shows progress; only this one calls MPI.
  const boost::mpi::environment environment(argc, argv, boost::mpi::threading::funneled);
  try {
    const Communicator world = Communicator::duplicate(boost::mpi::communicator());
    const cli::Session session{world, std::vector<std::string>(argv, argv + argc), start,
                               std::chrono::steady_clock::now()};
    return cli::flush_output(session, cli::run_and_report(argc, argv, session));
  } catch (const std::exception &bug) {
    // Not agreed on, so the other ranks may be waiting for this one.
    fmt::print(stderr, "dovetail: unexpected: {}\n", bug.what());
    boost::mpi::environment::abort(cli::failure);
  }
}
