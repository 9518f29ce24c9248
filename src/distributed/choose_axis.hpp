/// Along which axis slabs are cut.
#pragma once

#include "dovetail/base/types.hpp"
#include "dovetail/comm/communicator.hpp"
#include "point_sketch.hpp"

#include <span>
#include <vector>

namespace dovetail {

/// So many points are enough to tell.
inline constexpr std::size_t axis_sample_size = std::size_t{1} << 14;

/// Local. x, unless cuts along y give split paths of half the length or less, as they do for sites that hug a
/// vertical line. Judged by the paths of a sample (point_sketch.hpp) at a few lines.
Axis choose_axis(const std::vector<Point> &sample);

/// Collective. The same of the points of all ranks: a function of their set.
Axis choose_axis(const Communicator &comm, std::span<const Point> points);

/// Collective. The sketches of all ranks as one, on every rank. O(log ranks) messages, of a sketch's points
/// in all where ranks have few points in common, and a broadcast.
std::vector<Point> sample_of_all(const Communicator &comm, PointSketch sketch);

/// Local. Sites on the paths of the quartile lines together. The sites must be distinct.
std::size_t quartile_path_sites(std::vector<Point> sites, Axis axis);

} // namespace dovetail
