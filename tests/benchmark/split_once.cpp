// One split of the split-path kernel: on presorted points, from the box to its two halves.
//   split_once DISTRIBUTION N [REPEATS [SEED]]
// The points are presorted anew for every run, which is not timed. A line of JSON: processor time in ns a
// point, length of the path.
#include "kernel_driver.hpp"

#include "mesh/box_splitting.hpp"

using namespace dovetail;

namespace {

/// The timed region, and a name to count instructions by.
[[gnu::noinline]] Chain split_once(BoxSplitting &boxes, const Box &box) {
  const SplitLine line = boxes.middle(box);
  const Ends ends = boxes.ends(box, line);
  const Chain path = boxes.path(box, line, ends);
  boxes.divide(box, line, ends, path);
  return path;
}

} // namespace

int main(int argc, char **argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: %s DISTRIBUTION N [REPEATS [SEED]]\n", argv[0]);
    return 2;
  }
  const int repeats = argc > 3 ? std::atoi(argv[3]) : 1;
  const std::uint64_t seed = argc > 4 ? std::strtoull(argv[4], nullptr, 10) : 1;
  const std::vector<Point> points = benchmark::points_from(argv[1], std::strtoll(argv[2], nullptr, 10), seed);
  const auto sites = static_cast<double>(points.size());
  std::printf("{\"source\": \"%s\", \"sites\": %zu, \"ns\": [", argv[1], points.size());
  std::size_t path = 0;
  for (int i = 0; i < repeats; ++i) {
    BoxSplitting boxes(presort(points));
    const Box box = boxes.whole();
    const double start = benchmark::cpu_seconds();
    path = split_once(boxes, box).size();
    std::printf("%s%.3f", i == 0 ? "" : ", ", 1e9 * (benchmark::cpu_seconds() - start) / sites);
  }
  std::printf("], \"path\": %zu}\n", path);
  return 0;
}
