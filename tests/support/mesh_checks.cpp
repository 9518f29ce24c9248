#include "support/mesh_checks.hpp"

#include <algorithm>
#include <random>

namespace dovetail::testing {

std::vector<Point> distinct_sites(Distribution distribution, GlobalIndex n) {
  std::vector<Point> sites(static_cast<std::size_t>(n));
  generate_points({distribution, n, 3}, 0, sites);
  std::ranges::sort(sites, lexicographically_less);
  sites.erase(std::unique(sites.begin(), sites.end()), sites.end());
  std::mt19937_64 random(1);
  std::ranges::shuffle(sites, random);
  return sites;
}

std::uint64_t checksum_of(const std::vector<Point> &sites, const Triangulation &mesh) {
  return checksum_of_sites(sites) + checksum_of_triangles(sites, mesh.corners);
}

std::string first_fault(const FaultReport &report) {
  return report.valid()
             ? ""
             : std::string(name_of(report.first_faults[0].kind)) + ": " + report.first_faults[0].text;
}

} // namespace dovetail::testing
