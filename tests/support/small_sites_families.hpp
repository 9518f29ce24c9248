/// Small integer sites of the kinds that break Delaunay codes.
#pragma once

#include "support/small_sites_oracle.hpp"

#include <random>
#include <string>
#include <vector>

namespace dovetail::testing {

inline constexpr int small_sites_family_count = 12;

std::string small_sites_family_name(int family);

/// Distinct sites in random order; from none to about `most`.
std::vector<IntegerSite> small_sites(int family, int most, std::mt19937_64 &random);

} // namespace dovetail::testing
