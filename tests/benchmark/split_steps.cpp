// All that the split-path kernel does with a few points, for drawing it: jobs/split-path does.
//   split_steps DISTRIBUTION N [SEED]
// JSON: the sites, and for every split its depth, its line, and its path by numbers of sites.
#include "kernel_driver.hpp"

#include "mesh/box_splitting.hpp"

#include <utility>

using namespace dovetail;

namespace {

void print_splits(BoxSplitting &boxes, const Box &box, int depth) {
  if (box.interior() == 0)
    return;
  const SplitLine line = boxes.middle(box);
  const Ends ends = boxes.ends(box, line);
  const Chain path = boxes.path(box, line, ends);
  std::printf("%s{\"depth\": %d, \"axis\": \"%s\", \"line\": %.17g, \"path\": [", depth == 0 ? "" : ",\n",
              depth, line.axis == Axis::x ? "x" : "y", line.position);
  const char *comma = "";
  for (const LocalIndex v : boxes.sites(path))
    std::printf("%s%d", std::exchange(comma, ", "), v);
  std::printf("]}");
  const auto [low, high] = boxes.divide(box, line, ends, path);
  print_splits(boxes, low, depth + 1);
  print_splits(boxes, high, depth + 1);
  boxes.drop(path);
}

} // namespace

int main(int argc, char **argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: %s DISTRIBUTION N [SEED]\n", argv[0]);
    return 2;
  }
  const std::uint64_t seed = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1;
  BoxSplitting boxes(presort(benchmark::points_from(argv[1], std::strtoll(argv[2], nullptr, 10), seed)));
  std::printf("{\"sites\": [");
  const char *comma = "";
  for (const Point p : boxes.points())
    std::printf("%s[%.17g, %.17g]", std::exchange(comma, ", "), p.x, p.y);
  std::printf("],\n\"splits\": [");
  print_splits(boxes, boxes.whole(), 0);
  std::printf("]}\n");
  return 0;
}
