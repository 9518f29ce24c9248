/// What tests of meshes in one process share.
#pragma once

#include "dovetail/geometry/distributions.hpp"
#include "dovetail/mesh/checksum.hpp"
#include "dovetail/mesh/triangulation.hpp"
#include "dovetail/mesh/validate.hpp"

#include <string>
#include <vector>

namespace dovetail::testing {

/// In random order.
std::vector<Point> distinct_sites(Distribution distribution, GlobalIndex n);

std::uint64_t checksum_of(const std::vector<Point> &sites, const Triangulation &mesh);

/// Empty if there is none.
std::string first_fault(const FaultReport &report);

} // namespace dovetail::testing
