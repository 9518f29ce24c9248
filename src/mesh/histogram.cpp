#include "dovetail/mesh/histogram.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <numeric>

namespace dovetail {
namespace {

using Offset = std::vector<double>::difference_type;

/// Whether a bound is the power of ten 10^(k step) for some k. Bounds are correctly rounded, so text tells.
bool is_power_of_ten(double bound, int step) {
  const std::string text = fmt::format("{:e}", bound);
  return text.starts_with("1.000000e") && std::atoi(text.c_str() + text.find('e') + 1) % step == 0;
}

/// The same values in the bins between those of the bounds for which `keep` holds, and the outermost two.
template <class Keep> Histogram rebinned(const Histogram &fine, Keep &&keep) {
  Histogram coarse({fine.bounds.front(), fine.bounds.back()});
  coarse.bounds.pop_back();
  coarse.counts.clear();
  GlobalIndex count = 0;
  for (std::size_t bin = 0; bin < fine.counts.size(); ++bin) {
    count += fine.counts[bin];
    if (bin + 1 == fine.counts.size() || keep(bin + 1)) {
      coarse.bounds.push_back(fine.bounds[bin + 1]);
      coarse.counts.push_back(count);
      count = 0;
    }
  }
  coarse.lowest = fine.lowest;
  coarse.highest = fine.highest;
  return coarse;
}

} // namespace

Histogram::Histogram(std::vector<double> bin_bounds)
    : bounds(std::move(bin_bounds)), counts(bounds.size() - 1, 0) {}

void Histogram::add(double value) {
  const auto above = std::upper_bound(bounds.begin() + 1, bounds.end() - 1, value) - bounds.begin();
  ++counts[static_cast<std::size_t>(above - 1)];
  lowest = std::min(lowest, value);
  highest = std::max(highest, value);
}

GlobalIndex Histogram::total() const { return std::accumulate(counts.begin(), counts.end(), GlobalIndex{0}); }

std::vector<double> bounds_of_magnitudes() {
  std::vector<double> bounds{0};
  for (int exponent = -307; exponent <= 308; ++exponent)
    for (const char digit : {'1', '2', '5'})
      if (exponent < 308 || digit == '1')
        bounds.push_back(std::strtod(fmt::format("{}e{}", digit, exponent).c_str(), nullptr));
  return bounds;
}

std::vector<double> even_bounds(double first, double last, double step) {
  std::vector<double> bounds{first};
  for (int i = 1; bounds.back() < last; ++i)
    bounds.push_back(first + i * step);
  return bounds;
}

Histogram trimmed(const Histogram &histogram) {
  const auto filled = [](GlobalIndex count) { return count > 0; };
  const auto first = std::find_if(histogram.counts.begin(), histogram.counts.end(), filled);
  const auto last = std::find_if(histogram.counts.rbegin(), histogram.counts.rend(), filled).base();
  const Offset begin = first < last ? first - histogram.counts.begin() : 0;
  const Offset end = first < last ? last - histogram.counts.begin() : 1;
  Histogram result(std::vector<double>(histogram.bounds.begin() + begin, histogram.bounds.begin() + end + 1));
  result.counts.assign(histogram.counts.begin() + begin, histogram.counts.begin() + end);
  result.lowest = histogram.lowest;
  result.highest = histogram.highest;
  return result;
}

Histogram condensed(const Histogram &magnitudes, GlobalIndex tail, std::size_t bins) {
  const Histogram whole = trimmed(magnitudes);
  GlobalIndex below = 0;
  std::size_t first = 0;
  while (first + 1 < whole.counts.size() && below + whole.counts[first] <= tail)
    below += whole.counts[first++];
  GlobalIndex above = 0;
  std::size_t end = whole.counts.size();
  while (end > first + 1 && above + whole.counts[end - 1] <= tail)
    above += whole.counts[--end];
  Histogram result = rebinned(whole, [&](std::size_t bound) { return bound >= first && bound <= end; });
  for (int step = 1; result.counts.size() > bins && step < 1024; step *= 2) {
    const std::vector<double> bounds = result.bounds;
    result = rebinned(result, [&](std::size_t bound) { return is_power_of_ten(bounds[bound], step); });
  }
  return result;
}

void CompensatedSum::add(double term) {
  const double next = sum_ + term;
  if (std::abs(sum_) >= std::abs(term))
    rest_ += (sum_ - next) + term;
  else
    rest_ += (term - next) + sum_;
  sum_ = next;
}

} // namespace dovetail
