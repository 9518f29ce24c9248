#include "options.hpp"

#include "text.hpp"

#include <CLI/CLI.hpp>

#include <stdexcept>
#include <unistd.h>

namespace dovetail::cli {

void add_telling_options(CLI::App &parser, Telling &telling) {
  parser.add_option("--report", telling.report, "Write a record of the run, for programs, as JSON")
      ->option_text("FILE.json");
  parser.add_flag("--quiet", telling.quiet, "Print nothing but errors");
  parser.add_flag("--progress", telling.progress, "Show progress in one live line, also without a terminal");
}

std::string fault_of_name(const std::string &name) {
  if (name.empty())
    return "a file's name is empty";
  // Every rank reads its own part, and mpirun passes standard input to one of them alone.
  return name == "-" ? "standard input is not read, so save it to a file first and name that (a file called "
                       "'-' is './-')"
                     : "";
}

void add_class_option(CLI::App &parser, std::vector<int> &classes) {
  parser
      .add_option_function<std::string>(
          "--class",
          [&classes](const std::string &text) {
            try {
              classes = classes_from_text(text);
            } catch (const std::invalid_argument &problem) {
              throw CLI::ValidationError("--class", problem.what());
            }
          },
          "LAS input: only points of these classes, such as 2 (ground) and 9 (water)")
      ->option_text("2,9");
}

ProgressStyle progress_style(bool is_root, const Telling &telling) {
  if (!is_root || telling.quiet)
    return ProgressStyle::silent;
  return telling.progress || isatty(STDERR_FILENO) == 1 ? ProgressStyle::live : ProgressStyle::lines;
}

dovetail::Progress progress_into(ProgressMeter &meter) {
  return [&meter](std::string_view stage, double fraction) { meter.update(stage, fraction); };
}

} // namespace dovetail::cli
