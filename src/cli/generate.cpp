// dovetail generate: synthetic points, the same for every number of ranks.
#include "command.hpp"
#include "options.hpp"
#include "output.hpp"
#include "report.hpp"
#include "text.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/phases.hpp"
#include "dovetail/geometry/distributions.hpp"
#include "dovetail/io/points.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace dovetail::cli {
namespace {

struct GenerateOptions {
  SyntheticSet set;
  std::string output;
  Telling telling;
};

const std::vector<std::string> phase_names{"generate", "write"};

std::string distribution_names() {
  std::vector<std::string_view> names;
  for (const Distribution distribution : all_distributions)
    names.push_back(distribution_name(distribution));
  return joined(names, ", ");
}

/// Rank r has the points from floor(n r / ranks) on.
PointTable generate_share(const SyntheticSet &set, int rank, int ranks, const Progress &progress) {
  const GlobalIndex whole = set.n / ranks;
  const GlobalIndex rest = set.n % ranks;
  const auto first_of = [&](int r) { return whole * r + rest * r / ranks; };
  const GlobalIndex first = first_of(rank);
  const auto count = static_cast<std::size_t>(first_of(rank + 1) - first);

  PointTable table;
  table.points.resize(count);
  table.input_index.resize(count);
  std::iota(table.input_index.begin(), table.input_index.end(), first);
  if (has_height(set.distribution))
    table.attributes.push_back({"z", std::vector<double>(count)});

  constexpr std::size_t at_once = std::size_t{1} << 20; // points between two words of progress
  for (std::size_t begin = 0; begin < count; begin += at_once) {
    const std::size_t end = std::min(count, begin + at_once);
    const GlobalIndex number = first + static_cast<GlobalIndex>(begin);
    generate_points(set, number, std::span(table.points).subspan(begin, end - begin));
    for (Attribute &z : table.attributes)
      generate_heights(set, number, std::span(z.values).subspan(begin, end - begin));
    report_progress(progress, "generate", static_cast<double>(end) / static_cast<double>(count));
  }
  return table;
}

ExitCode generate(const GenerateOptions &options, const Session &session) {
  const Communicator &comm = session.comm;
  check_points_output(comm, options.output, {});
  check_report(comm, options.telling.report, {}, std::span(&options.output, 1));

  ProgressMeter meter(progress_style(comm.is_root(), options.telling), {{"generate", 1}, {"write", 2}});
  PhaseLog phases(comm);
  meter.begin("generate");
  const PointTable points = phases.measure("generate", [&] {
    return collectively(
        comm, [&] { return generate_share(options.set, comm.rank(), comm.size(), progress_into(meter)); });
  });
  meter.begin("write");
  phases.measure("write",
                 [&] { write_points(comm, points, options.output, {.progress = progress_into(meter)}); });
  meter.finish();

  const std::vector<PhaseSummary> times = summarise(comm, phases);
  Report report = new_report(session, "generate", {});
  report["output"] = options.output;
  report["points"] = options.set.n;
  report["phases"] = phases_as_json(phase_names, times);
  write_report(session, std::move(report), options.telling.report);
  if (comm.is_root() && !options.telling.quiet) {
    print_row("generated", fmt::format("{}, {}, seed {}", counted(options.set.n, "point", "points"),
                                       distribution_name(options.set.distribution), options.set.seed));
    print_row("time", times_text(session, times));
    print_row("wrote", options.output);
  }
  return success;
}

constexpr const char *details = R"(Distributions:
  uniform   in the unit square
  normal    both coordinates standard normal
  kuzmin    heavy-tailed around the origin: radius with the distribution 1 - 1/sqrt(1 + r^2)
  line      hugging the line x = 0.001
  lattice   integers in random order, ceil(sqrt N) columns, last row partial
  circle    on the unit circle, rounded
  lidar     in a square kilometre, rounded to 0.01, so with duplicates; with a height z
  clusters  sqrt N normal clusters of width 0.001 in the unit square
Point i is a function of distribution, N, seed and i alone: the same for every number of ranks.

Examples:
  dovetail generate uniform -n 1000000 --seed 1 -o uniform.npy
  dovetail generate lattice -n 1e4 -o lattice.csv
  mpirun -n 2 dovetail generate lidar -n 2.5e6 --seed 42 -o survey.npy
)";

} // namespace

Subcommand add_generate(CLI::App &app) {
  CLI::App *parser = app.add_subcommand("generate", "Make synthetic points");
  parser->footer(details);
  const auto options = std::make_shared<GenerateOptions>();
  parser
      ->add_option_function<std::string>(
          "DISTRIBUTION",
          [options](const std::string &name) {
            const std::optional<Distribution> known = distribution_named(name);
            if (!known)
              throw CLI::ValidationError("'" + name + "' is none of " + distribution_names());
            options->set.distribution = *known;
          },
          "One of those below")
      ->required()
      ->option_text(" ");
  parser
      ->add_option_function<std::string>(
          "-n,--number",
          [options](const std::string &text) {
            try {
              options->set.n = count_from_text(text);
            } catch (const std::invalid_argument &problem) {
              throw CLI::ValidationError("-n", problem.what());
            }
          },
          "Number of points, such as 1000000 or 1e6")
      ->required()
      ->option_text("N (required)");
  parser
      ->add_option_function<std::string>(
          "--seed",
          [options](const std::string &text) {
            try {
              options->set.seed = seed_from_text(text);
            } catch (const std::invalid_argument &problem) {
              throw CLI::ValidationError("--seed", problem.what());
            }
          },
          "Another seed, other points")
      ->option_text("S [0]");
  parser->add_option("-o,--output", options->output, "File to write: " + known_point_extensions(true))
      ->required()
      ->option_text("FILE (required)");
  add_telling_options(*parser, options->telling);
  return {parser, [options](const Session &session) { return generate(*options, session); }};
}

} // namespace dovetail::cli
