/// Histograms whose counts can be added, so that they do not depend on who counted what. Local.
#pragma once

#include "dovetail/base/types.hpp"

#include <limits>
#include <vector>

namespace dovetail {

/// counts[i] values were not below bounds[i] and below bounds[i + 1]; the first bin also has all below it,
/// the last all above it.
struct Histogram {
  std::vector<double> bounds; ///< ascending, one more than bins
  std::vector<GlobalIndex> counts;
  double lowest = std::numeric_limits<double>::infinity(); ///< of the values; infinity if there are none
  double highest = -std::numeric_limits<double>::infinity();

  explicit Histogram(std::vector<double> bin_bounds = {0, 0});
  void add(double value);
  GlobalIndex total() const;
};

/// Bounds for positive values of any size: 0, then 1, 2 and 5 times every power of ten.
std::vector<double> bounds_of_magnitudes();
/// first, first + step, ..., at least up to last.
std::vector<double> even_bounds(double first, double last, double step);

/// Without the empty bins at both ends; an empty histogram keeps its first bin.
Histogram trimmed(const Histogram &histogram);

/// For people: up to `tail` values at either end share one bin, and while there are more than `bins` bins,
/// the magnitudes are coarsened to whole powers of ten (10^2, 10^4, ... after that).
Histogram condensed(const Histogram &magnitudes, GlobalIndex tail, std::size_t bins);

/// A sum that hardly rounds: Neumaier's. What it yields depends on the order of its terms.
class CompensatedSum {
public:
  void add(double term);
  double value() const { return sum_ + rest_; }

private:
  double sum_ = 0;
  double rest_ = 0;
};

} // namespace dovetail
