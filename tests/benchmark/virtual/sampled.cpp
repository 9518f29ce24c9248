#include "sampled.hpp"

#include "dovetail/distributed/triangulate_region.hpp"
#include "dovetail/geometry/split_path.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <stdexcept>
#include <utility>

namespace dovetail::virtual_ranks {
namespace {

using synthetic::Draws;

std::size_t index(int i) { return static_cast<std::size_t>(i); }

/// Ascending numbers, independent and uniform between `low` and `high`: gaps are exponential.
std::vector<double> ascending(std::size_t count, double low, double high, Draws &draws) {
  std::vector<double> sums(count + 1);
  double sum = 0;
  for (double &each : sums)
    each = sum -= synthetic::logarithm(1 - draws.unit());
  sums.pop_back();
  for (double &each : sums)
    each = low + (high - low) * (each / sum);
  return sums;
}

/// The abscissa of a normal point with so much of the set left of it, near a guess; u is at most about 1/2.
double normal_quantile(double u, double guess) {
  double x = guess;
  for (int step = 0; step < 60; ++step) { // Newton; two steps unless the guess is bad
    const double density = std::exp(-x * x / 2) / std::sqrt(2 * std::numbers::pi);
    const double change = (std::erfc(-x / std::numbers::sqrt2) / 2 - u) / density;
    x -= std::clamp(change, -0.5, 0.5); // far out the steps would overshoot
    if (std::fabs(change) < 1e-14 * std::max(1.0, std::fabs(x)))
      break;
  }
  return x;
}

double normal_draw(Draws &draws) {
  for (;;) { // Marsaglia's polar method
    const double a = 2 * draws.unit() - 1, b = 2 * draws.unit() - 1;
    const double squared = a * a + b * b;
    if (squared > 0 && squared < 1)
      return a * std::sqrt(-2 * synthetic::logarithm(squared) / squared);
  }
}

/// Of the plane's Kuzmin density (1 + x^2 + y^2)^(-3/2) / (2 pi), x alone has the density of Cauchy, and y,
/// in units of sqrt(1 + x^2), the distribution t / (2 sqrt(1 + t^2)) + 1/2 for every x.
double kuzmin_quantile(double u) { return -1 / std::tan(std::numbers::pi * u); }
double kuzmin_draw(double x, Draws &draws) {
  const double v = 2 * draws.unit() - 1;
  return std::sqrt((1 + x * x) / ((1 - v) * (1 + v) + 0x1p-60)) * v;
}

double line_draw(Draws &draws) {
  constexpr double b = 0.001;
  const double u = draws.unit();
  return b / (u - b * u + b);
}

double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// What scanning all slabs gives.
struct Scan {
  std::vector<double> lines;   ///< of border b, between slab b and the next
  std::map<int, Path> paths;   ///< of the borders asked for
  std::vector<double> hulls_s; ///< processor time for the two own hulls of every slab
};

/// Right hulls are scanned on the way forwards, left ones on the way back. Of thin slabs hulls are nearly all
/// of their points, too many to keep: then the slab is made once more.
Scan scan(const SlabwiseSet &set, const std::set<int> &borders, GlobalIndex most_kept) {
  Scan result;
  result.hulls_s.resize(index(set.slabs()));
  const auto hull = [&](int slab, const std::vector<Point> &points, SplitLine line) {
    const double start = processor_seconds();
    Path path = own_hull(points, set.points_of_slab() * slab, line);
    result.hulls_s[index(slab)] += processor_seconds() - start;
    return path;
  };
  const auto line = [&](int border) { return SplitLine{result.lines[index(border)], set.axis()}; };
  std::vector<Path> left_hulls(index(set.slabs()));
  GlobalIndex kept = 0;
  Path chain;
  for (int s = 0; s < set.slabs(); ++s) {
    const std::vector<Point> points = set.slab(s);
    if (s > 0 && kept < most_kept) {
      left_hulls[index(s)] = hull(s, points, line(s - 1));
      kept += std::ssize(left_hulls[index(s)]);
    }
    if (s + 1 == set.slabs())
      break;
    result.lines.push_back(across(points.back(), set.axis()));
    chain = hull_of_both(chain, hull(s, points, line(s)), line(s));
    if (borders.contains(s))
      result.paths[s] = chain;
  }
  chain.clear();
  for (int s = set.slabs() - 1; s > 0; --s) {
    const Path &kept_hull = left_hulls[index(s)];
    chain =
        hull_of_both(chain, kept_hull.empty() ? hull(s, set.slab(s), line(s - 1)) : kept_hull, line(s - 1));
    if (borders.contains(s - 1))
      result.paths[s - 1] = hull_of_both(result.paths[s - 1], chain, line(s - 1));
  }
  return result;
}

/// Every so many slabs one, the outermost not among them unless there are few.
std::set<int> evenly_spaced(int slabs, int count) {
  std::set<int> chosen;
  for (int i = 0; i < count; ++i)
    chosen.insert(static_cast<int>(static_cast<std::int64_t>(slabs) * (2 * i + 1) / (2 * count)));
  return chosen;
}

/// The borders of some slabs, and those at which the first groups of every level of the recursion are cut.
std::set<int> borders_of(const std::set<int> &sampled, int slabs) {
  std::set<int> borders;
  for (const int slab : sampled)
    for (const int border : {slab - 1, slab})
      if (border >= 0 && border + 1 < slabs)
        borders.insert(border);
  for (int half = slabs / 2; half > 0; half /= 2)
    borders.insert(half - 1);
  return borders;
}

/// One slab as the rank that owns it has it when it begins to triangulate.
Region region_of(const SlabwiseSet &set, const Scan &all, int slab) {
  Region region;
  Slabs &slabs = region.slabs;
  slabs.axis = set.axis();
  slabs.lines = all.lines;
  slabs.site_offsets = slab_offsets(set.points_of_slab() * set.slabs(), set.slabs());
  slabs.first_slab = slab;
  slabs.own_slab_count = 1;
  slabs.sites.points = set.slab(slab);
  slabs.sites.input_index.resize(slabs.sites.points.size());
  std::iota(slabs.sites.input_index.begin(), slabs.sites.input_index.end(), slabs.first_site());
  region.paths = {slab > 0 ? all.paths.at(slab - 1) : Path(),
                  slab + 1 < set.slabs() ? all.paths.at(slab) : Path()};
  return region;
}

} // namespace

SlabwiseSet::SlabwiseSet(const SyntheticSet &set, int slabs) : set_(set), slabs_(slabs) {
  switch (set.distribution) {
  case Distribution::uniform:
  case Distribution::normal:
  case Distribution::kuzmin:
  case Distribution::line:
    break;
  default:
    throw std::invalid_argument("only uniform, normal, kuzmin and line sets can be made slab by slab");
  }
  if (set.n % slabs != 0 || set.n / slabs < 1)
    throw std::invalid_argument("every slab must have the same number of points, at least one");
}

std::vector<Point> SlabwiseSet::slab(int number) const {
  // Where the set is symmetric the right half is made as the mirror image of the left one: quantiles near 1
  // would lack digits.
  const bool mirrored =
      (set_.distribution == Distribution::normal || set_.distribution == Distribution::kuzmin) &&
      number >= (slabs_ + 1) / 2;
  const int like = mirrored ? slabs_ - 1 - number : number;
  constexpr std::uint64_t stream_slabs = 100; // no stream of geometry/distributions.cpp
  Draws draws(synthetic::stream_key(set_.seed, stream_slabs), static_cast<std::uint64_t>(number));
  const std::vector<double> parts =
      ascending(static_cast<std::size_t>(points_of_slab()), static_cast<double>(like) / slabs_,
                static_cast<double>(like + 1) / slabs_, draws);
  std::vector<Point> points;
  points.reserve(parts.size());
  double x = -1; // of the point before
  for (const double u : parts)
    switch (set_.distribution) {
    case Distribution::normal:
      x = normal_quantile(u, x);
      points.push_back({x, normal_draw(draws)});
      break;
    case Distribution::kuzmin:
      x = kuzmin_quantile(u);
      points.push_back({x, kuzmin_draw(x, draws)});
      break;
    case Distribution::line:
      points.push_back({line_draw(draws), u});
      break;
    default:
      points.push_back({u, draws.unit()});
    }
  if (mirrored)
    for (Point &point : points)
      point.x = -point.x;
  std::ranges::sort(points, TotalOrder{axis()}); // rounding may have made equals, or swapped neighbours
  const auto repeated = std::ranges::unique(points);
  if (!repeated.empty())
    throw std::invalid_argument("equal points: the set is too dense for doubles");
  return points;
}

SampledRun run_sampled(const SlabwiseSet &set, int sample, GlobalIndex most_kept) {
  // Averages are over the evenly spaced slabs, extremes also over those that are likely to be extreme.
  const std::set<int> evenly = evenly_spaced(set.slabs(), sample);
  std::set<int> chosen = evenly;
  chosen.insert({0, set.slabs() / 2, set.slabs() - 1});

  const Scan all = scan(set, borders_of(chosen, set.slabs()), most_kept);
  SampledRun run;
  run.hull_max_s = *std::ranges::max_element(all.hulls_s);
  run.hull_mean_s = std::accumulate(all.hulls_s.begin(), all.hulls_s.end(), 0.0) / set.slabs();
  run.sampled_slabs = static_cast<int>(chosen.size());
  for (const auto &[border, path] : all.paths)
    run.longest_path = std::max(run.longest_path, static_cast<GlobalIndex>(path.size()));
  const auto count = static_cast<double>(evenly.size());
  const auto lines = static_cast<double>(evenly.size() - evenly.count(0)); // left of them
  for (const int slab : chosen) {
    UnstitchedMesh mesh;
    double taken = std::numeric_limits<double>::max();
    for (int time = 0; time < 2; ++time) { // the better of two: what disturbed one, belongs to no slab
      Region region = region_of(set, all, slab);
      const double start = processor_seconds();
      mesh = triangulate_region(std::move(region));
      taken = std::min(taken, processor_seconds() - start);
    }
    run.triangulate_max_s = std::max(run.triangulate_max_s, taken);
    run.path_sites_max = std::max(run.path_sites_max, mesh.path_sites);
    if (evenly.contains(slab)) {
      run.triangulate_mean_s += taken / count;
      run.mean_path += static_cast<double>(mesh.mesh.slabs.front().left_path.size()) / lines;
      run.mean_ghosts += static_cast<double>(mesh.mesh.slabs.front().ghost_number.size()) / count;
    }
  }
  return run;
}

} // namespace dovetail::virtual_ranks
