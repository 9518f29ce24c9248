/// What the refinement drivers share: arguments, domain, the clock and the line of JSON that they print. Each
/// mesher is a program of its own, so that none warms the memory or the caches of another.
#pragma once

#include "dovetail/geometry/distributions.hpp"
#include "dovetail/mesh/domain.hpp"

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace dovetail::benchmark {

struct Task {
  PlanarGraph graph;
  bool in_hull; ///< the convex hull is the domain
  double min_angle;
  double max_area; ///< 0: none
};

struct Outcome {
  std::size_t vertices;
  std::size_t triangles;
  bool valid;
};

inline double cpu_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Triangle's .poly with its own vertices; enough for A.poly.
inline PlanarGraph graph_from(const std::string &name) {
  std::ifstream file(name);
  if (!file) {
    std::fprintf(stderr, "%s is neither a distribution, nor square, nor a .poly file\n", name.c_str());
    std::exit(2);
  }
  std::string text;
  for (std::string line; std::getline(file, line);)
    text += line.substr(0, line.find('#')) + "\n";
  std::istringstream words(text);
  const auto read = [&] {
    double value = 0;
    words >> value;
    return value;
  };
  const auto skip = [&](int count) {
    while (count-- > 0)
      read();
  };
  PlanarGraph graph;
  const int vertices = static_cast<int>(read());
  skip(1);
  const int columns = static_cast<int>(read()) + static_cast<int>(read());
  LocalIndex first = 0;
  for (int i = 0; i < vertices; ++i) {
    const auto number = static_cast<LocalIndex>(read());
    first = i == 0 ? number : first;
    const double x = read(), y = read();
    graph.vertices.push_back({x, y});
    skip(columns);
  }
  const int segments = static_cast<int>(read()), has_marker = static_cast<int>(read());
  for (int i = 0; i < segments; ++i) {
    skip(1);
    const auto from = static_cast<LocalIndex>(read()) - first, to = static_cast<LocalIndex>(read()) - first;
    graph.segments.push_back({from, to, 1});
    skip(has_marker);
  }
  const int holes = static_cast<int>(read());
  for (int i = 0; i < holes; ++i) {
    skip(1);
    const double x = read(), y = read();
    graph.holes.push_back({x, y});
  }
  return graph;
}

inline Task task_from(char **argv) {
  const std::string source = argv[1];
  Task task{{}, true, std::atof(argv[3]), std::atof(argv[4])};
  if (const auto distribution = distribution_named(source)) {
    const GlobalIndex n = std::strtoll(argv[2], nullptr, 10);
    task.graph.vertices.resize(static_cast<std::size_t>(n));
    generate_points({*distribution, n, 1}, 0, task.graph.vertices);
  } else if (source == "square") {
    task.graph.vertices = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  } else {
    task.graph = graph_from(source);
    task.in_hull = false;
  }
  return task;
}

/// main() of a driver: PROGRAM DISTRIBUTION|square|FILE.poly POINTS MIN_ANGLE MAX_AREA. `mesher` takes the
/// task, from points or segments in memory to the refined mesh in memory: that is the timed region;
/// `outcome_of`, which validates, is outside it again. The points of a distribution must be distinct.
template <class Mesher, class OutcomeOf>
int drive(int argc, char **argv, const char *name, Mesher mesher, OutcomeOf outcome_of) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: %s DISTRIBUTION|square|FILE.poly POINTS MIN_ANGLE MAX_AREA\n", argv[0]);
    return 2;
  }
  const Task task = task_from(argv);
  const double start = cpu_seconds();
  const auto mesh = mesher(task);
  const double seconds = cpu_seconds() - start;
  const Outcome outcome = outcome_of(task, mesh);
  std::printf("{\"mesher\": \"%s\", \"source\": \"%s\", \"seconds\": %.4f, \"vertices\": %zu, "
              "\"triangles\": %zu, \"valid\": %s}\n",
              name, argv[1], seconds, outcome.vertices, outcome.triangles, outcome.valid ? "true" : "false");
  return 0;
}

} // namespace dovetail::benchmark
