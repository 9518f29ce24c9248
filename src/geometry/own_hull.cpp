#include "dovetail/geometry/split_path.hpp"

namespace dovetail {
namespace {

/// A slab's sites as seen from the line: number 0 is the nearest, or one of them.
class Outward {
public:
  Outward(std::span<const Point> sites, GlobalIndex first_number, bool line_is_after)
      : sites_(sites), first_number_(first_number), line_is_after_(line_is_after) {}

  std::size_t size() const { return sites_.size(); }
  std::size_t index(std::size_t k) const { return line_is_after_ ? sites_.size() - 1 - k : k; }
  Point point(std::size_t k) const { return sites_[index(k)]; }
  PathSite numbered(std::size_t k) const {
    return {point(k), first_number_ + static_cast<GlobalIndex>(index(k))};
  }

private:
  std::span<const Point> sites_;
  GlobalIndex first_number_;
  bool line_is_after_;
};

/// The first of the sites k = begin .. end - 1 that is farther from the line than `reach`.
std::size_t first_beyond(const Outward &sites, std::size_t begin, std::size_t end, double reach,
                         SplitLine line) {
  while (begin < end) {
    const std::size_t k = begin + (end - begin) / 2;
    if (std::fabs(across(sites.point(k), line.axis) - line.position) > reach)
      end = k;
    else
      begin = k + 1;
  }
  return begin;
}

void add_lowest_and_highest(const Outward &sites, Axis axis, std::vector<PathSite> &to) {
  std::size_t lowest = 0, highest = 0;
  double low = along(sites.point(0), axis), high = low;
  for (std::size_t k = 1; k < sites.size(); ++k) {
    const double position = along(sites.point(k), axis);
    if (position < low) {
      low = position;
      lowest = k;
    }
    if (position > high) {
      high = position;
      highest = k;
    }
  }
  to.push_back(sites.numbered(lowest));
  to.push_back(sites.numbered(highest));
}

} // namespace

/// A strip of sites next to the line, with the lowest and the highest of all, makes an approximate path; the
/// others follow outwards, in batches as large as all before them, and of each only what the path so far lets
/// through. Since the path spans all sites, those beyond its reach need not be looked at.
Path own_hull(std::span<const Point> sites, GlobalIndex first_number, SplitLine line) {
  const std::size_t n = sites.size();
  const bool line_is_after = n == 0 || across(sites.back(), line.axis) <= line.position;
  const bool line_is_before = n == 0 || across(sites.front(), line.axis) >= line.position;
  const Outward outward(sites, first_number, line_is_after);

  const auto strip = static_cast<std::size_t>(64 + 4 * std::sqrt(static_cast<double>(n)));
  std::size_t seen = line_is_after || line_is_before ? std::min(strip, n) : n;
  std::vector<PathSite> candidates;
  for (std::size_t k = 0; k < seen; ++k)
    candidates.push_back(outward.numbered(k));
  if (seen < n)
    add_lowest_and_highest(outward, line.axis, candidates);
  Path path = split_path(std::move(candidates), line);

  while (seen < n) {
    const PathFilter filter(path, line);
    const std::size_t end = first_beyond(outward, seen, n, filter.reach(), line);
    const std::size_t batch_end = std::min(end, 2 * seen);
    std::vector<PathSite> passed;
    for (std::size_t k = seen; k < batch_end; ++k)
      if (filter.lets_through(outward.point(k)))
        passed.push_back(outward.numbered(k));
    path = merge_paths(path, split_path(std::move(passed), line), line);
    seen = batch_end == end ? n : batch_end;
  }
  return path;
}

} // namespace dovetail
