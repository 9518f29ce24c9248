// The real pipeline on any number of virtual ranks in one process (world.hpp), from points in memory
// to a stitched mesh. Prints one JSON object: what the mesh is, what was sent (exactly what as many real
// ranks send), and how long it would have taken on as many processors with the network given. See
// jobs/virtual.
#include "sampled.hpp"
#include "world.hpp"

#include "../mapped_memory.hpp"

#include "dovetail/distributed/triangulate.hpp"
#include "dovetail/geometry/distributions.hpp"
#include "dovetail/mesh/checksum.hpp"
#include "dovetail/mesh/divide_and_conquer.hpp"

#include <CLI/CLI.hpp>
#include <boost/mpi/environment.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <ctime>
#include <numeric>
#include <optional>
#include <string>

using namespace dovetail;
using namespace dovetail::virtual_ranks;

namespace {

struct Options {
  SyntheticSet set{Distribution::uniform, 0, 1};
  int ranks = 1;
  int slabs = 0;
  Network network;
  bool kernel = false;
  bool sampled = false;
  GlobalIndex kept_hulls = 50'000'000;
  bool progress = false;
};

double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// What a rank has spent so far.
struct Reading {
  Time time;
  Traffic traffic;
};

/// A rank's own account of its phases, which it hears of as any progress meter does.
class Account {
public:
  Account(World &world, const Traffic &traffic) : world_(world), traffic_(traffic) {}

  void hear(std::string_view stage) {
    if (names_.empty() || names_.back() != stage) {
      names_.emplace_back(stage);
      starts_.push_back(read());
    }
  }
  void end() { starts_.push_back(read()); }

  const std::vector<std::string> &names() const { return names_; }
  Reading of_phase(std::size_t i) const {
    const Reading &from = starts_[i], &to = starts_[i + 1];
    return {{to.time.clock - from.time.clock, to.time.worked - from.time.worked},
            {to.traffic.bytes_sent - from.traffic.bytes_sent,
             to.traffic.messages_sent - from.traffic.messages_sent}};
  }

private:
  Reading read() { return {world_.time(), traffic_}; }

  World &world_;
  const Traffic &traffic_;
  std::vector<std::string> names_;
  std::vector<Reading> starts_;
};

/// What a rank would have read of a file with these points: read_points shares records out like this.
PointTable share_of(const SyntheticSet &set, int rank, int ranks) {
  const auto first_of = [&](int r) { return set.n / ranks * r + std::min<GlobalIndex>(r, set.n % ranks); };
  const GlobalIndex begin = first_of(rank), end = first_of(rank + 1);
  PointTable table;
  table.points.resize(static_cast<std::size_t>(end - begin));
  generate_points(set, begin, table.points);
  table.input_index.resize(table.points.size());
  std::iota(table.input_index.begin(), table.input_index.end(), begin);
  if (has_height(set.distribution)) {
    table.attributes.push_back({"z", std::vector<double>(table.points.size())});
    generate_heights(set, begin, table.attributes.front().values);
  }
  return table;
}

/// What is the same on all ranks.
struct Result {
  Axis axis = Axis::x;
  int slabs = 0;
  GlobalIndex sites = 0;
  GlobalIndex triangles = 0;
  std::uint64_t checksum = 0;
  MeshStatistics statistics;
  std::vector<std::vector<Reading>> phases; ///< of every rank
  std::vector<std::string> phase_names;
};

Result run(const Options &options) {
  Result result;
  result.phases.resize(static_cast<std::size_t>(options.ranks));
  World *here = nullptr;
  World world(options.ranks, options.network, [&](int rank) {
    const Communicator comm = Communicator::duplicate(MPI_COMM_WORLD);
    PointTable points = share_of(options.set, rank, options.ranks);
    here->restart_clock();
    Account account(*here, comm.traffic());
    TriangulateOptions how;
    how.slabs.slabs = options.slabs;
    how.slabs.progress = [&](std::string_view stage, double fraction) {
      account.hear(stage);
      if (options.progress && fraction == 0 && rank % std::max(1, options.ranks / 4) == 0)
        fmt::print(stderr, "  rank {} of {}: {}\n", rank, options.ranks, stage);
    };
    const DistributedMesh mesh = triangulate(comm, std::move(points), how);
    account.end();
    for (std::size_t i = 0; i < account.names().size(); ++i)
      result.phases[static_cast<std::size_t>(rank)].push_back(account.of_phase(i));
    if (rank == 0)
      result = {mesh.axis,     mesh.slab_count(), mesh.site_count(),        mesh.triangle_count(),
                mesh.checksum, mesh.statistics,   std::move(result.phases), account.names()};
  });
  here = &world;
  world.run();
  return result;
}

nlohmann::ordered_json phase_as_json(const Result &result, std::size_t phase) {
  Reading largest, sum;
  for (const std::vector<Reading> &rank : result.phases) {
    const Reading &one = rank[phase];
    largest.time.clock = std::max(largest.time.clock, one.time.clock);
    largest.time.worked = std::max(largest.time.worked, one.time.worked);
    sum.time.clock += one.time.clock;
    sum.time.worked += one.time.worked;
    sum.traffic.bytes_sent += one.traffic.bytes_sent;
    sum.traffic.messages_sent += one.traffic.messages_sent;
  }
  const auto ranks = static_cast<double>(result.phases.size());
  return {{"name", result.phase_names[phase]},
          {"wall_max_s", largest.time.clock},
          {"wall_mean_s", sum.time.clock / ranks},
          {"cpu_max_s", largest.time.worked},
          {"cpu_sum_s", sum.time.worked},
          {"bytes_sent", sum.traffic.bytes_sent},
          {"messages_sent", sum.traffic.messages_sent}};
}

/// The kernel alone, on all points of the set: in the order of the input, duplicates dropped.
double kernel_seconds(const SyntheticSet &set) {
  std::vector<Point> points(static_cast<std::size_t>(set.n));
  generate_points(set, 0, points);
  const double start = processor_seconds();
  const Triangulation triangles = delaunay(points);
  return triangles.triangle_count() > 0 ? processor_seconds() - start : 0;
}

/// What both kinds of runs have.
nlohmann::ordered_json common(const Options &options, Axis axis, int slabs) {
  return {{"distribution", distribution_name(options.set.distribution)},
          {"points", options.set.n},
          {"seed", options.set.seed},
          {"ranks", options.ranks},
          {"slabs", slabs},
          {"axis", axis == Axis::x ? "x" : "y"},
          {"network",
           {{"latency_s", options.network.latency_s},
            {"overhead_s", options.network.overhead_s},
            {"bytes_per_second", options.network.bytes_per_second}}}};
}

nlohmann::ordered_json run_exactly(const Options &options) {
  constexpr std::size_t bytes_of_point = 120;
  benchmark::keep_mapped_memory(bytes_of_point * static_cast<std::size_t>(options.set.n));
  const Result result = run(options);
  const MeshStatistics &statistics = result.statistics;
  nlohmann::ordered_json json = common(options, result.axis, result.slabs);
  json["sites"] = result.sites;
  json["triangles"] = result.triangles;
  json["checksum"] = checksum_text(result.checksum);
  json["own_sites_max"] = statistics.own_sites_max;
  json["path_sites_max"] = statistics.path_sites_max;
  json["candidate_sites_max"] = statistics.candidate_sites_max;
  json["path_sites"] = statistics.path_sites;
  json["longest_path"] = statistics.longest_path;
  json["ghosts"] = statistics.ghosts;
  for (std::size_t phase = 0; phase < result.phase_names.size(); ++phase)
    json["phases"].push_back(phase_as_json(result, phase));
  if (options.kernel)
    json["kernel_s"] = kernel_seconds(options.set);
  return json;
}

nlohmann::ordered_json run_a_sample(const Options &options) {
  constexpr int slabs_to_triangulate = 13;
  constexpr std::size_t bytes_of_slab_point = 240;
  const SlabwiseSet set(options.set, options.ranks);
  benchmark::keep_mapped_memory(bytes_of_slab_point * static_cast<std::size_t>(set.points_of_slab()));
  const SampledRun run = run_sampled(set, slabs_to_triangulate, options.kept_hulls);
  nlohmann::ordered_json json = common(options, set.axis(), options.ranks);
  json["sampled_slabs"] = run.sampled_slabs;
  json["own_sites_max"] = set.points_of_slab();
  json["path_sites_max"] = run.path_sites_max;
  json["path_sites"] = static_cast<GlobalIndex>(run.mean_path * (options.ranks - 1));
  json["longest_path"] = run.longest_path;
  json["ghosts"] = static_cast<GlobalIndex>(run.mean_ghosts * options.ranks);
  json["hull_max_s"] = run.hull_max_s;
  json["hull_mean_s"] = run.hull_mean_s;
  json["triangulate_max_s"] = run.triangulate_max_s;
  json["triangulate_mean_s"] = run.triangulate_mean_s;
  return json;
}

Options options_from(int argc, char **argv) {
  Options options;
  std::string distribution = "uniform";
  double points = 0;
  CLI::App app("The pipeline on virtual ranks; prints a JSON object. See jobs/virtual.");
  app.add_option("distribution", distribution)->required();
  app.add_option("points", points, "in all")->required()->check(CLI::NonNegativeNumber);
  app.add_option("ranks", options.ranks)->required()->check(CLI::PositiveNumber);
  app.add_option("--seed", options.set.seed);
  app.add_option("--slabs", options.slabs)->check(CLI::NonNegativeNumber);
  app.add_option("--latency", options.network.latency_s, "seconds")->check(CLI::NonNegativeNumber);
  app.add_option("--overhead", options.network.overhead_s, "seconds a message")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--bandwidth", options.network.bytes_per_second, "bytes a second")
      ->check(CLI::PositiveNumber);
  app.add_flag("--kernel", options.kernel, "time the sequential kernel on all points as well");
  app.add_flag("--sampled", options.sampled, "of a set too large for memory: a sample of its slabs");
  app.add_option("--kept-hulls", options.kept_hulls, "sites of hulls to keep in memory, for --sampled");
  app.add_flag("--progress", options.progress);
  try {
    app.parse(argc, argv);
    const auto known = distribution_named(distribution);
    if (!known)
      throw CLI::ValidationError("distribution", "'" + distribution + "' is not known");
    options.set.distribution = *known;
    options.set.n = static_cast<GlobalIndex>(points);
  } catch (const CLI::ParseError &error) {
    std::exit(app.exit(error));
  }
  return options;
}

} // namespace

int main(int argc, char **argv) {
  const Options options = options_from(argc, argv);
  const boost::mpi::environment environment;
  try {
    nlohmann::ordered_json json = options.sampled ? run_a_sample(options) : run_exactly(options);
    json["processor_s"] = processor_seconds();
    json["peak_rss_bytes"] = peak_rss_bytes();
    fmt::print("{}\n", json.dump());
  } catch (const std::exception &error) {
    fmt::print(stderr, "virtual_ranks: {}\n", error.what());
    return 1;
  }
  return 0;
}
