#include "merge_runs.hpp"

namespace dovetail {
namespace {

/// Where the runs begin, empty ones left out, and the end.
std::vector<std::size_t> begins_of(std::span<const std::int64_t> lengths) {
  std::vector<std::size_t> begins{0};
  for (const std::int64_t length : lengths)
    if (length > 0)
      begins.push_back(begins.back() + static_cast<std::size_t>(length));
  return begins;
}

/// True if no run begins before the one in front of it ends.
bool ascends_as_it_lies(std::span<const Point> points, std::span<const std::size_t> begins, Axis axis) {
  return std::all_of(begins.begin(), begins.end(), [&](std::size_t begin) {
    return begin == 0 || begin == points.size() || !TotalOrder{axis}(points[begin], points[begin - 1]);
  });
}

/// Merges [begin, middle) with [middle, end). Of equal points, those on the left come first.
template <Axis axis>
void merge_two(const Point *from, std::size_t begin, std::size_t middle, std::size_t end, Point *to,
               std::uint8_t *from_right) {
  // No && nor ||: which point is less is as good as random.
  const auto less = [](Point a, Point b) {
    return static_cast<std::size_t>(across(a, axis) < across(b, axis)) |
           (static_cast<std::size_t>(across(a, axis) == across(b, axis)) &
            static_cast<std::size_t>(along(a, axis) < along(b, axis)));
  };
  std::size_t left = begin, right = middle, place = begin;
  for (; left < middle && right < end; ++place) {
    const std::size_t taken = less(from[right], from[left]);
    from_right[place] = static_cast<std::uint8_t>(taken);
    to[place] = from[left + ((right - left) & (0 - taken))];
    right += taken;
    left += 1 - taken;
  }
  std::fill(from_right + place, from_right + end, static_cast<std::uint8_t>(right < end));
  std::copy(from + left, from + middle, to + place);
  std::copy(from + right, from + end, to + place + (middle - left));
}

template <Axis axis>
std::vector<MergeRound> merge_rounds(std::span<Point> arrived, std::vector<std::size_t> begins,
                                     std::span<Point> merged) {
  std::vector<MergeRound> rounds;
  std::span<Point> from = arrived, to = merged;
  while (begins.size() > 2) {
    if (begins.size() % 2 == 0)
      begins.push_back(begins.back());
    MergeRound round{begins, std::vector<std::uint8_t>(arrived.size())};
    std::vector<std::size_t> next{0};
    for (std::size_t p = 0; p + 2 < begins.size(); p += 2) {
      merge_two<axis>(from.data(), begins[p], begins[p + 1], begins[p + 2], to.data(),
                      round.from_right.data());
      next.push_back(begins[p + 2]);
    }
    rounds.push_back(std::move(round));
    begins = std::move(next);
    std::swap(from, to);
  }
  if (from.data() != merged.data())
    std::copy(from.begin(), from.end(), merged.begin());
  return rounds;
}

} // namespace

std::vector<MergeRound> merge_points(std::span<Point> arrived, std::span<const std::int64_t> lengths,
                                     Axis axis, std::span<Point> merged) {
  std::vector<std::size_t> begins = begins_of(lengths);
  if (ascends_as_it_lies(arrived, begins, axis))
    begins = {0, arrived.size()};
  return axis == Axis::x ? merge_rounds<Axis::x>(arrived, std::move(begins), merged)
                         : merge_rounds<Axis::y>(arrived, std::move(begins), merged);
}

} // namespace dovetail
