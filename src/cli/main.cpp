// The command `dovetail`. All ranks parse the same command line, run the same subcommand and leave with the
// same exit code; rank 0 alone prints.
#include "command.hpp"
#include "interrupt.hpp"
#include "process_memory.hpp"
#include "text.hpp"
#include "version.hpp"

#include "dovetail/base/error.hpp"
#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"

#include <CLI/CLI.hpp>
#include <boost/mpi/environment.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <new>
#include <sstream>
#include <system_error>

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
  dovetail stats stars.vtkhdf
  dovetail render stars.vtkhdf -o stars.png
Each command has its own help, such as dovetail triangulate --help.
)";

/// What is wrong with a word that nothing on the command line takes. CLI11 complains of a missing required
/// option before it complains of this one, which is often that option misspelt.
std::string problem_of_extra(const CLI::App &app, const CLI::App *command) {
  const std::vector<std::string> before = app.remaining();
  if (command != nullptr && !before.empty())
    return fmt::format("'{}' stands before {}, and options come after it", before.front(),
                       command->get_name());
  const std::vector<std::string> extra = app.remaining(true);
  const std::string &word = extra.front();
  if (!word.starts_with('-') || word.size() == 1)
    return fmt::format("'{}' is one argument too many", word);
  std::error_code ignored;
  return fmt::format(
      "there is no option '{}'{}", word,
      std::filesystem::exists(word, ignored) ? fmt::format(" (the file of this name is './{}')", word) : "");
}

/// An option without its value, or with several.
std::string problem_of_count(const CLI::App *command, const std::string &message) {
  const std::string name = message.substr(0, message.find(':'));
  const CLI::Option *option = command == nullptr ? nullptr : command->get_option_no_throw(name);
  if (option == nullptr)
    return message;
  return fmt::format("{} {}", name, option->count() > 1 ? "is given more than once" : "needs a value");
}

std::string problem_text(const CLI::App &app, const CLI::App *command, const CLI::ParseError &error) {
  const auto kind = static_cast<CLI::ExitCodes>(error.get_exit_code());
  if ((kind == CLI::ExitCodes::RequiredError || kind == CLI::ExitCodes::ExtrasError) &&
      !app.remaining(true).empty())
    return problem_of_extra(app, command);
  std::string problem = error.what();
  if (kind == CLI::ExitCodes::ArgumentMismatch)
    return problem_of_count(command, problem);
  if (problem.starts_with("A ") || problem.starts_with("The "))
    problem.front() = static_cast<char>(problem.front() - 'A' + 'a');
  return problem;
}

/// A wrong command line, help and version end here, before any work, and alike on all ranks.
ExitCode explain(const CLI::App &app, const CLI::ParseError &error, const Communicator &world) {
  if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) {
    std::ostringstream text;
    app.exit(error, text, text);
    if (world.is_root())
      fmt::print("{}", text.str());
    return success;
  }
  const auto chosen = app.get_subcommands();
  const CLI::App *const command = chosen.empty() ? nullptr : chosen.front();
  if (world.is_root())
    fmt::print(stderr, "dovetail: {}; see dovetail{} --help\n", problem_text(app, command, error),
               command == nullptr ? "" : " " + command->get_name());
  return wrong_usage;
}

/// CLI11 would call a misspelt command an unexpected argument.
void refuse_unknown_command(const CLI::App &app, const std::vector<std::string> &command_line) {
  if (command_line.size() < 2 || command_line[1].starts_with('-'))
    return;
  std::vector<std::string> names;
  for (const CLI::App *command : app.get_subcommands([](const CLI::App *) { return true; }))
    names.push_back(command->get_name());
  if (std::find(names.begin(), names.end(), command_line[1]) == names.end())
    throw CLI::ValidationError(
        fmt::format("there is no subcommand '{}' among {}", command_line[1], joined(names, ", ")));
}

ExitCode run(int argc, char **argv, const Session &session) {
  CLI::App app(description, "dovetail");
  app.footer(examples);
  app.set_version_flag("--version", version_text, "Print the versions of dovetail and its libraries");
  app.require_subcommand(1);
  const std::vector<Subcommand> subcommands{
      add_triangulate(app), add_generate(app), add_verify(app),    add_info(app),   add_convert(app),
      add_stats(app),       add_render(app),   add_constrain(app), add_refine(app), add_insert(app)};
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
  cli::keep_freed_memory();
  cli::keep_memory_reserve();
  // A thread of its own shows progress; only this one calls MPI.
  const boost::mpi::environment environment(argc, argv, boost::mpi::threading::funneled);
  try {
    const Communicator world = Communicator::duplicate(boost::mpi::communicator());
    const cli::InterruptWatch interrupts(world.is_root());
    const cli::Session session{world, std::vector<std::string>(argv, argv + argc), start,
                               std::chrono::steady_clock::now()};
    return cli::flush_output(session, cli::run_and_report(argc, argv, session));
  } catch (const std::exception &bug) {
    // Not agreed on, so the other ranks may be waiting for this one.
    if (dynamic_cast<const std::bad_alloc *>(&bug) != nullptr)
      fmt::print(stderr, "dovetail: {}\n", Error(current_problem()).what());
    else
      fmt::print(stderr, "dovetail: unexpected: {}\n", bug.what());
    boost::mpi::environment::abort(cli::failure);
  }
}
