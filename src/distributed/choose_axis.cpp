#include "choose_axis.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/exchange.hpp"
#include "dovetail/geometry/distributions.hpp"
#include "dovetail/geometry/split_path.hpp"

#include <algorithm>
#include <array>
#include <vector>

namespace dovetail {
namespace {

constexpr GlobalIndex sample_size = 1 << 14;

/// This rank's part of the sample: its points are those from `first` on of `total`.
std::vector<Point> sample(std::span<const Point> points, GlobalIndex first, GlobalIndex total) {
  const GlobalIndex count = std::ssize(points);
  const GlobalIndex block = std::max<GlobalIndex>(1, (total + sample_size - 1) / sample_size);
  std::vector<Point> chosen;
  for (GlobalIndex b = first / block; b * block < first + count; ++b) {
    const auto draw = synthetic::mix(static_cast<std::uint64_t>(b) + synthetic::golden_gamma);
    const GlobalIndex at = b * block + static_cast<GlobalIndex>(draw % static_cast<std::uint64_t>(block));
    if (at >= first && at < first + count)
      chosen.push_back(points[static_cast<std::size_t>(at - first)]);
  }
  return chosen;
}

/// Sites on the paths of the quartile lines together.
std::size_t path_sites(std::vector<Point> sites, Axis axis) {
  if (sites.empty())
    return 0;
  std::vector<PathSite> ascending;
  ascending.reserve(sites.size());
  const Axis other = axis == Axis::x ? Axis::y : Axis::x;
  std::sort(sites.begin(), sites.end(), TotalOrder{other});
  for (const Point &site : sites)
    ascending.push_back({site, 0});
  std::size_t length = 0;
  for (const std::size_t quarter : {1u, 2u, 3u}) {
    const auto at = sites.begin() + static_cast<std::ptrdiff_t>(quarter * sites.size() / 4);
    std::nth_element(sites.begin(), at, sites.end(), TotalOrder{axis});
    length += split_path_of_ascending(ascending, {across(*at, axis), axis}).size();
  }
  return length;
}

} // namespace

Axis choose_axis(const Communicator &comm, std::span<const Point> points) {
  const GlobalIndex count = std::ssize(points);
  const GlobalIndex first = exclusive_scan(comm, count);
  const GlobalIndex total = all_reduce_sum(comm, count);
  const auto purpose = [] { return "a sample of the points"; };
  const std::vector<Point> own = collectively(comm, purpose, [&] { return sample(points, first, total); });
  const std::vector<Point> all = gather_bulk<Point>(comm, own).data;
  int choose_y = collectively(comm, purpose, [&] {
    const bool chooses = comm.is_root() && !all.empty();
    return chooses && 2 * path_sites(all, Axis::y) <= path_sites(all, Axis::x) ? 1 : 0;
  });
  broadcast(comm, choose_y);
  return choose_y != 0 ? Axis::y : Axis::x;
}

} // namespace dovetail
