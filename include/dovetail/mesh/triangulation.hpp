/// A triangulation as flat arrays over somebody else's points.
#pragma once

#include "dovetail/base/types.hpp"

#include <span>
#include <vector>

namespace dovetail {

/// Triangle t has the corners corners[3t], corners[3t + 1], corners[3t + 2] counter-clockwise; across from
/// corner i lies triangle neighbours[3t + i], or `none` beyond the hull. Every corner is a vertex number.
struct Triangulation {
  std::vector<LocalIndex> corners;
  std::vector<LocalIndex> neighbours;
  LocalIndex triangle_count() const { return static_cast<LocalIndex>(corners.size() / 3); }
};

} // namespace dovetail
