/// An order in which points are best inserted. Local.
#pragma once

#include "dovetail/base/types.hpp"

#include <span>
#include <vector>

namespace dovetail {

/// Numbers of all points, in rounds of which each has seven times as many points as all before it, each along
/// Hilbert's curve. In which round a point comes is random (a function of its number and of nothing else), so
/// that cavities stay small whatever the points; along a round each is near to the last (Amenta, Choi and
/// Rote, Incremental constructions con BRIO, 2003), however unevenly they lie: where many share one of the
/// curve's 2^16 x 2^16 places, they have a curve of their own. O(n) for each such level, by counting; 20
/// bytes a point while it works.
std::vector<LocalIndex> space_filling_order(std::span<const Point> points);

} // namespace dovetail
