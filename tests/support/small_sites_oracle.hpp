/// Brute-force canonical Delaunay triangulation of small sets of integer sites, from the definition.
#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <span>

namespace dovetail::testing {

struct IntegerSite {
  std::int64_t x;
  std::int64_t y;
  friend constexpr auto operator<=>(const IntegerSite &, const IntegerSite &) = default;
};

/// Three site numbers, ascending.
using Triple = std::array<int, 3>;

/// Every triple whose plane through the lifted, perturbed corners has all other sites above it: the lower
/// hull of (x, y, x^2 + y^2 + epsilon), with an epsilon for each site that dominates those of all
/// lexicographically smaller sites. Exact while coordinates differ by less than 2^29. O(n^4).
std::set<Triple> delaunay_by_definition(std::span<const IntegerSite> sites);

} // namespace dovetail::testing
