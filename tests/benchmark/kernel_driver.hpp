/// What the kernel drivers share: arguments, points, the clock and the line of JSON that they print. Each
/// kernel is a program of its own, so that none warms the memory or the caches of another.
#pragma once

#include "mapped_memory.hpp"

#include "dovetail/geometry/distributions.hpp"
#include "dovetail/mesh/checksum.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <new>
#include <span>
#include <string>
#include <sys/resource.h>
#include <vector>

namespace dovetail::benchmark {

struct Result {
  std::size_t triangles;
  std::uint64_t checksum;
  bool valid;
};

/// All that this program has asked for on the heap so far; see operator new below.
inline std::size_t allocations = 0;

inline double cpu_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Current and greatest size of this process in bytes; a kernel that frees before it ends still shows.
inline std::size_t memory_bytes(const char *field) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(field))
      return 1024 * std::stoul(line.substr(line.find_first_of("0123456789")));
  return 0;
}

/// Distinct points, in the order given: kernels number distinct sites.
inline void drop_duplicates(std::vector<Point> &points) {
  std::vector<LocalIndex> order(points.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    order[i] = static_cast<LocalIndex>(i);
  const auto at = [&](LocalIndex i) { return points[static_cast<std::size_t>(i)]; };
  std::ranges::sort(order, [&](LocalIndex a, LocalIndex b) {
    return lexicographically_less(at(a), at(b)) || (at(a) == at(b) && a < b);
  });
  std::vector<bool> drop(points.size(), false);
  for (std::size_t i = 1; i < order.size(); ++i)
    if (at(order[i]) == at(order[i - 1]))
      drop[static_cast<std::size_t>(order[i])] = true;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!drop[i])
      points[kept++] = points[i];
  points.resize(kept);
}

inline std::vector<Point> points_from(const std::string &source, GlobalIndex n, std::uint64_t seed) {
  std::vector<Point> points;
  if (const auto distribution = distribution_named(source)) {
    points.resize(static_cast<std::size_t>(n));
    generate_points({*distribution, n, seed}, 0, points);
  } else {
    std::ifstream file(source, std::ios::binary | std::ios::ate);
    if (!file) {
      std::fprintf(stderr, "%s is neither a distribution nor a file of coordinate pairs\n", source.c_str());
      std::exit(2);
    }
    points.resize(static_cast<std::size_t>(file.tellg()) / sizeof(Point));
    file.seekg(0);
    file.read(reinterpret_cast<char *>(points.data()),
              static_cast<std::streamsize>(points.size() * sizeof(Point)));
  }
  drop_duplicates(points);
  return points;
}

/// main() of a driver: PROGRAM SOURCE N [REPEATS [SEED]]. `prepare` gives the coordinates in the kernel's own
/// form; `kernel` takes them to triangles and neighbours in memory: that is the timed region; `result_of`,
/// which validates, is outside it again. Sites in the order of the input, duplicates dropped. Allocations and
/// peak memory are those of the first run.
template <class Prepare, class Kernel, class ResultOf>
int drive(int argc, char **argv, const char *name, Prepare prepare, Kernel kernel, ResultOf result_of) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: %s DISTRIBUTION|FILE.f64 N [REPEATS [SEED]]\n", argv[0]);
    return 2;
  }
  const GlobalIndex n = std::strtoll(argv[2], nullptr, 10);
  const int repeats = argc > 3 ? std::atoi(argv[3]) : 1;
  const std::uint64_t seed = argc > 4 ? std::strtoull(argv[4], nullptr, 10) : 1;
  const auto input = prepare(points_from(argv[1], n, seed));
  const auto sites = static_cast<double>(input.size());
  keep_memory();
  std::ofstream("/proc/self/clear_refs") << 5; // forget the peak of making the points
  const std::size_t memory_before = memory_bytes("VmRSS");
  std::printf("{\"kernel\": \"%s\", \"source\": \"%s\", \"sites\": %zu, \"ns\": [", name, argv[1],
              input.size());
  std::size_t peak = 0;
  std::size_t allocated = 0;
  for (int i = 0; i < repeats; ++i) {
    const std::size_t allocated_before = allocations;
    const double start = cpu_seconds();
    const auto mesh = kernel(input);
    const double seconds = cpu_seconds() - start;
    if (i == 0) {
      allocated = allocations - allocated_before;
      peak = memory_bytes("VmHWM") - memory_before;
    }
    std::printf("%s%.1f", i == 0 ? "" : ", ", 1e9 * seconds / sites);
    if (i + 1 == repeats) {
      const Result result = result_of(input, mesh);
      std::printf("], \"peak_bytes\": %.1f, \"allocations\": %zu, \"triangles\": %zu, \"checksum\": \"%s\", "
                  "\"valid\": %s}\n",
                  static_cast<double>(peak) / sites, allocated, result.triangles,
                  checksum_text(result.checksum).c_str(), result.valid ? "true" : "false");
    }
  }
  return 0;
}

} // namespace dovetail::benchmark

// Counted, and otherwise what the standard library does; the array and sized forms end here too. Not inline,
// as the language demands: a driver is one translation unit.
void *operator new(std::size_t size) {
  ++dovetail::benchmark::allocations;
  if (void *memory = std::malloc(size != 0 ? size : 1))
    return memory;
  throw std::bad_alloc();
}
void operator delete(void *memory) noexcept { std::free(memory); }
void operator delete(void *memory, std::size_t) noexcept { std::free(memory); }
