#include "merge_runs.hpp"

#include <array>

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

/// What is left of two sorted runs to be merged.
struct Merge {
  std::size_t left, left_end, right, right_end;
  /// So many steps do not exhaust a run.
  std::size_t sure_steps() const { return std::min(left_end - left, right_end - right); }
};

/// Merges [begin, middle) with [middle, end). Of equal points, those on the left come first.
template <Axis axis> class TwoRuns {
public:
  TwoRuns(const Point *from, std::size_t begin, std::size_t middle, std::size_t end)
      : from_(from), begin_(begin), middle_(middle), end_(end) {}

  /// Every step of a merge waits for the one before, so several go on at a time, each with its own part of
  /// the result.
  void merge(Point *to, std::uint8_t *from_right) const {
    constexpr std::size_t parts = 4;
    std::array<Merge, parts> merges;
    std::size_t left = begin_, right = middle_;
    for (std::size_t part = 0; part < parts; ++part) {
      const std::size_t end = begin_ + (end_ - begin_) * (part + 1) / parts;
      merges[part] = {left, lefts_before(end), right, 0};
      left = merges[part].left_end;
      right = merges[part].right_end = middle_ + (end - left);
    }
    const auto step = [&](Merge &part) {
      const std::size_t taken = less(from_[part.right], from_[part.left]);
      const std::size_t place = place_of(part);
      from_right[place] = static_cast<std::uint8_t>(taken);
      to[place] = from_[part.left + ((part.right - part.left) & (0 - taken))];
      part.right += taken;
      part.left += 1 - taken;
    };
    while (const std::size_t steps = std::ranges::min(merges, {}, &Merge::sure_steps).sure_steps())
      for (std::size_t i = 0; i < steps; ++i)
        for (Merge &part : merges)
          step(part);
    for (Merge &part : merges) {
      while (part.sure_steps() > 0)
        step(part);
      const std::size_t place = place_of(part), lefts = part.left_end - part.left;
      std::fill_n(from_right + place, lefts, std::uint8_t{0});
      std::fill_n(from_right + place + lefts, part.right_end - part.right, std::uint8_t{1});
      std::copy(from_ + part.left, from_ + part.left_end, to + place);
      std::copy(from_ + part.right, from_ + part.right_end, to + place + lefts);
    }
  }

private:
  // No && nor ||: which point is less is as good as random.
  static std::size_t less(Point a, Point b) {
    return static_cast<std::size_t>(across(a, axis) < across(b, axis)) |
           (static_cast<std::size_t>(across(a, axis) == across(b, axis)) &
            static_cast<std::size_t>(along(a, axis) < along(b, axis)));
  }

  std::size_t place_of(const Merge &part) const { return part.left + (part.right - middle_); }

  /// Where the left run ends that fills, with some of the right one, all places before `place`.
  std::size_t lefts_before(std::size_t place) const {
    const std::size_t count = place - begin_, rights = end_ - middle_;
    std::size_t low = begin_ + (count > rights ? count - rights : 0), high = std::min(place, middle_);
    while (low < high) {
      const std::size_t left = low + (high - low) / 2, last_right = middle_ + (place - left) - 1;
      if (less(from_[last_right], from_[left]) != 0)
        high = left;
      else
        low = left + 1;
    }
    return low;
  }

  const Point *from_;
  std::size_t begin_, middle_, end_;
};

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
      TwoRuns<axis>(from.data(), begins[p], begins[p + 1], begins[p + 2])
          .merge(to.data(), round.from_right.data());
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
