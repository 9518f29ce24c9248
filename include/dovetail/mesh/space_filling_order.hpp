/// An order in which points are best inserted. Local.
#pragma once

#include "dovetail/base/types.hpp"

#include <span>
#include <vector>

namespace dovetail {

/// Numbers of all points, in rounds that double, each along Hilbert's curve. In which round a point comes is
/// random (a function of its number and of nothing else), so that cavities stay small whatever the points;
/// along a round each is near the last (Amenta, Choi and Rote, Incremental constructions con BRIO, 2003).
/// O(n log n); 16 bytes a point while it works.
std::vector<LocalIndex> space_filling_order(std::span<const Point> points);

} // namespace dovetail
