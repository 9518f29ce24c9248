#include "dovetail/distributed/forecast.hpp"

#include "choose_axis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace dovetail {
namespace {

constexpr double seconds_of_point = 1.3e-6, seconds_of_byte = 2e-9;

struct PathLaw {
  double length = 0, sample = 1, power = 0.5;
  double of(double sites) const { return std::min(sites, length * std::pow(sites / sample, power)); }
};

/// Mean length at the quartile lines.
double mean_path(const std::vector<Point> &sites, Axis axis) {
  return static_cast<double>(quartile_path_sites(sites, axis)) / 3;
}

PathLaw law_of(std::vector<Point> sample, Axis axis) {
  constexpr std::size_t enough = 256; // to tell laws apart
  if (sample.size() < enough)
    return {1.3, 1, 0.5};
  PathLaw law{mean_path(sample, axis), static_cast<double>(sample.size()), 0.5};
  sample.resize(sample.size() / 4);
  constexpr double clearly_more = 0.65; // than what a square root gives on samples
  const double power = std::log(law.length / mean_path(sample, axis)) / std::log(4.0);
  if (power > clearly_more)
    law.power = std::min(1.0, power);
  return law;
}

/// What a rank needs besides its own sites.
double bytes_between(const Undertaking &of, const Forecast &plan) {
  const double sites = static_cast<double>(of.points);
  const double lines_of_rank = std::min<double>(plan.slabs - 1.0, std::ceil(1.0 * plan.slabs / of.ranks) + 1);
  const double path = static_cast<double>(plan.path_sites);
  return lines_of_rank * path * bytes_of_path_site +
         (sites / plan.slabs + (plan.slabs > 1 ? 2 * path : 0)) * (bytes_of_slab_site + 8.0 * of.attributes);
}

int chosen_slabs(const Undertaking &of) {
  if (of.slabs > 0)
    return of.slabs;
  const GlobalIndex usual = default_slab_count(of.points, of.ranks);
  const GlobalIndex most = most_slab_sites(of.memory_bytes);
  const GlobalIndex each = (of.points + most * of.ranks - 1) / (most * of.ranks);
  return static_cast<int>(
      std::min<GlobalIndex>(std::max(usual, each * of.ranks), std::numeric_limits<int>::max()));
}

} // namespace

GlobalIndex most_slab_sites(std::int64_t memory_bytes) {
  return std::max<GlobalIndex>(
      500, static_cast<GlobalIndex>(static_cast<double>(memory_bytes) / 4 / bytes_of_slab_site));
}

Forecast forecast(const Undertaking &of, std::vector<Point> sample) {
  const double points = static_cast<double>(of.points), share = std::ceil(points / of.ranks);
  const double row = 24 + 8.0 * of.attributes, memory = static_cast<double>(of.memory_bytes);
  Forecast plan;
  plan.axis = of.axis == AxisChoice::automatic ? choose_axis(sample)
              : of.axis == AxisChoice::x       ? Axis::x
                                               : Axis::y;
  plan.path_sites = static_cast<GlobalIndex>(law_of(std::move(sample), plan.axis).of(points));

  // In memory: sorting, with what is exchanged between several ranks, or all sites while slabs come and go.
  plan.slabs = of.slabs > 0 ? of.slabs : default_slab_count(of.points, of.ranks);
  const double sorting = share * (row + (of.ranks > 1 ? 40 : 20));
  const double streaming = share * row + bytes_between(of, plan);
  const double keeping = share * (row + row + 90 + 60) + bytes_between(of, plan);
  double needed = of.keeps_mesh ? keeping : std::max(sorting, streaming);
  if ((needed > memory || of.on_disk) && !of.keeps_mesh) {
    plan.on_disk = true;
    plan.slabs = chosen_slabs(of);
    needed = bytes_between(of, plan);
    plan.scratch_bytes = static_cast<std::int64_t>(1.25 * points * row);
  }
  plan.fits = needed <= memory;
  plan.memory_bytes = static_cast<std::int64_t>(needed);
  const double vertices = points + 2.0 * static_cast<double>(plan.path_sites) * (plan.slabs - 1);
  plan.mesh_bytes =
      static_cast<std::int64_t>(vertices * (41 + 8.0 * of.attributes) + 2 * points * 41 + 65536);
  plan.seconds = share * seconds_of_point +
                 seconds_of_byte * static_cast<double>(plan.mesh_bytes + 3 * plan.scratch_bytes);
  return plan;
}

} // namespace dovetail
