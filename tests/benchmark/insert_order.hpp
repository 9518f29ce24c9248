/// What the drivers of insertion share: the ways to insert, and their points.
#pragma once

#include "kernel_driver.hpp"

#include "dovetail/mesh/space_filling_order.hpp"

#include <cstring>

namespace dovetail::benchmark {

enum class Way {
  ordered, ///< in space-filling order, made before the clock starts, with the last triangle as a hint
  batch,   ///< the same, sorting included
  random,  ///< in the order given, without hints
};

inline Way way_named(const char *name) {
  if (std::strcmp(name, "ordered") == 0)
    return Way::ordered;
  if (std::strcmp(name, "batch") == 0)
    return Way::batch;
  if (std::strcmp(name, "random") == 0)
    return Way::random;
  std::fprintf(stderr, "%s is not ordered, batch or random\n", name);
  std::exit(2);
}

/// The same order for every kernel.
inline std::vector<Point> in_order(const std::vector<Point> &points, Way way) {
  if (way != Way::ordered)
    return points;
  std::vector<Point> ordered;
  ordered.reserve(points.size());
  for (const LocalIndex i : space_filling_order(points))
    ordered.push_back(points[static_cast<std::size_t>(i)]);
  return ordered;
}

} // namespace dovetail::benchmark
