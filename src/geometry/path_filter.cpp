// How far from the line a site can be and still be let through, as a function of its position along the line:
// between two path sites i and j the chord of the lifted hull, less the square of the position, is
//   reach^2 = w_i d_i^2 + w_j d_j^2 + l_i l_j
// with the distances d of both from the line, the lengths l from the position to each of them, and the
// weights w_i = l_j / (l_i + l_j). All terms are positive, so a few roundings are a few units in the last
// place, which `rounded_up` makes up for. Where anything overflows the reach becomes infinite or NaN, and
// everything passes.

#include "dovetail/geometry/split_path.hpp"

#include <limits>

namespace dovetail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// 2^-40 is far more than all relative errors here, and 2^-530 more than what squares lose by underflow.
double rounded_up(double reach_squared) { return std::sqrt(reach_squared) * (1.0 + 0x1p-40) + 0x1p-530; }

/// The largest reach anywhere between two path sites: the reach squared is a parabola in the position, and
/// its vertex lies between the two if the difference of d^2 is less than the square of their gap.
double largest_reach(double gap, double distance, double next_distance) {
  const double square = distance * distance, next_square = next_distance * next_distance;
  const double gap_square = gap * gap;
  const double rise = std::fabs(next_square - square);
  const double largest = rise < gap_square
                             ? (square + next_square) / 2 + gap_square / 4 + rise / gap_square * (rise / 4)
                             : std::max(square, next_square);
  return largest < infinity ? rounded_up(largest) : infinity;
}

} // namespace

PathFilter::PathFilter(std::span<const PathSite> approximate, SplitLine line)
    : line_(line), reach_(infinity) {
  position_.reserve(approximate.size());
  distance_.reserve(approximate.size());
  for (const PathSite &site : approximate) {
    position_.push_back(along(site.point, line.axis));
    distance_.push_back(std::fabs(across(site.point, line.axis) - line.position));
  }
  if (approximate.size() < 2) {
    band_reach_.assign(2, infinity);
    return;
  }
  choose_bands();
  band_reach_.assign(2 * half_, 0.0);
  reach_ = 0;
  std::size_t from = band(position_.front());
  const std::size_t first = from;
  for (std::size_t i = 0; i + 1 < position_.size(); ++i) {
    const double reach = largest_reach(position_[i + 1] - position_[i], distance_[i], distance_[i + 1]);
    const std::size_t to = band(position_[i + 1]);
    for (std::size_t k = from; k <= to; ++k)
      band_reach_[k] = std::max(band_reach_[k], reach);
    reach_ = std::max(reach_, reach);
    pair_reach_.push_back(reach);
    from = to;
  }
  // Beyond the ends everything passes; the two bands that hold the ends leave it to the second look.
  std::fill_n(band_reach_.begin(), first + 1, infinity);
  std::fill(band_reach_.begin() + static_cast<std::ptrdiff_t>(from), band_reach_.end(), infinity);
}

/// About as many bands as path sites, with half of the path in the bands that are alike.
void PathFilter::choose_bands() {
  const std::size_t size = position_.size();
  middle_ = position_[size / 2];
  const double scale = position_[size - 1 - size / 4] / 2 - position_[size / 4] / 2;
  if (!(scale > 0 && 1 / scale < infinity))
    return; // two bands, and the second look decides
  per_scale_ = 1 / scale;
  const double farthest =
      std::max(middle_ - position_.front(), position_.back() - middle_) * per_scale_ + 1.0;
  const int octaves =
      1 + (farthest < infinity ? std::ilogb(farthest) : std::numeric_limits<double>::max_exponent);
  const auto bits = static_cast<int>(std::bit_width(4 * size / static_cast<std::size_t>(octaves)));
  shift_ = 52 - bits;
  half_ = static_cast<std::size_t>(octaves) << bits;
}

PathFilter::Interval PathFilter::quiet_interval(double distance) const {
  if (position_.size() < 2)
    return {0, 0};
  const std::size_t middle = position_.size() / 2;
  std::size_t low = middle, high = middle;
  while (low > 0 && pair_reach_[low - 1] < distance)
    --low;
  while (high < pair_reach_.size() && pair_reach_[high] < distance)
    ++high;
  return {position_[low], position_[high]};
}

bool PathFilter::is_within_reach(double position, double distance) const {
  if (position_.size() < 2 || position < position_.front() || position > position_.back())
    return true;
  const auto above = std::upper_bound(position_.begin() + 1, position_.end() - 1, position);
  const auto j = static_cast<std::size_t>(above - position_.begin());
  const double below_length = position - position_[j - 1], above_length = position_[j] - position;
  const double gap = position_[j] - position_[j - 1];
  // A weight that underflows may meet a large square: 2^-1000 is more than what it loses.
  const double reach_squared = (above_length / gap + 0x1p-1000) * (distance_[j - 1] * distance_[j - 1]) +
                               (below_length / gap + 0x1p-1000) * (distance_[j] * distance_[j]) +
                               below_length * above_length;
  return !(distance > rounded_up(reach_squared));
}

} // namespace dovetail
