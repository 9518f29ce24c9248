/// Along which axis slabs are cut. Collective.
#pragma once

#include "dovetail/base/types.hpp"
#include "dovetail/comm/communicator.hpp"

#include <span>

namespace dovetail {

/// x, unless cuts along y give split paths of half the length or less, as they do for sites that hug a
/// vertical line. Judged by the paths of a sample of about 16,000 points at a few lines; the sample depends
/// on the points in the order of the ranks, and not on where one rank ends and the next begins. A coordinate
/// that many points share is no trouble: the sample is one pseudo-random point of every block of consecutive
/// ones, so it does not resonate with rows or columns.
Axis choose_axis(const Communicator &comm, std::span<const Point> points);

} // namespace dovetail
