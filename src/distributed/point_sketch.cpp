#include "point_sketch.hpp"

#include "dovetail/geometry/distributions.hpp"

#include <algorithm>
#include <bit>
#include <tuple>
#include <utility>

namespace dovetail {
namespace {

std::uint64_t hash_of(Point p) {
  return synthetic::mix(synthetic::mix(std::bit_cast<std::uint64_t>(p.x) + synthetic::golden_gamma) ^
                        std::bit_cast<std::uint64_t>(p.y));
}

} // namespace

void PointSketch::add(std::span<const Point> points) {
  // Of many points the smallest hashes are known to be small: a few more than enough are looked for first,
  // which finds too few only where most points are equal to others.
  constexpr double more = 1.25;
  const double share = more * static_cast<double>(size_) / static_cast<double>(points.size());
  if (entries_.empty() && share < 0.5) {
    collect(points, static_cast<std::uint64_t>(share * 0x1p64));
    shrink();
    if (entries_.size() == size_)
      return;
    entries_.clear();
  }
  collect(points, limit_);
}

void PointSketch::collect(std::span<const Point> points, std::uint64_t limit) {
  for (const Point &point : points) {
    const std::uint64_t hash = hash_of(point);
    if (hash > limit)
      continue;
    entries_.push_back({hash, point});
    is_shrunk_ = false;
    if (entries_.size() >= 4 * size_) {
      shrink();
      limit = std::min(limit, limit_);
    }
  }
}

void PointSketch::shrink() {
  if (std::exchange(is_shrunk_, true))
    return;
  const auto key = [](const Entry &e) { return std::tuple(e.hash, e.point.x, e.point.y); };
  std::ranges::sort(entries_, {}, key);
  const auto same = [](const Entry &a, const Entry &b) { return a.point == b.point; };
  entries_.erase(std::unique(entries_.begin(), entries_.end(), same), entries_.end());
  if (entries_.size() >= size_) {
    entries_.resize(size_);
    limit_ = entries_.back().hash;
  }
}

std::vector<Point> PointSketch::points() {
  shrink();
  std::vector<Point> result;
  result.reserve(entries_.size());
  for (const Entry &entry : entries_)
    result.push_back(entry.point);
  return result;
}

std::int64_t PointSketch::count_up_to(std::uint64_t limit) {
  shrink();
  return std::ranges::upper_bound(entries_, limit, {}, &Entry::hash) - entries_.begin();
}

PointSketch PointSketch::up_to(std::uint64_t limit) {
  PointSketch result(size_);
  result.entries_.assign(entries_.begin(), entries_.begin() + count_up_to(limit));
  return result;
}

} // namespace dovetail
