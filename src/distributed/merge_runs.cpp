#include "merge_runs.hpp"

#include "sort_points.hpp"

#include <bit>
#include <limits>

namespace dovetail {
namespace {

/// The tree has a leaf for every run; every node above knows which run of its subtree has the least next
/// point. Keys are of `across`, and only a tie looks at `along`.
class WinnerTree {
public:
  WinnerTree(std::span<const Point> points, std::span<const std::int64_t> lengths, Axis axis)
      : points_(points), axis_(axis), leaves_(std::bit_ceil(lengths.size())), key_(leaves_, exhausted),
        next_(leaves_, 0), end_(leaves_, 0), winner_(2 * leaves_) {
    std::size_t end = 0;
    for (std::size_t run = 0; run < leaves_; ++run) {
      next_[run] = end;
      end += run < lengths.size() ? static_cast<std::size_t>(lengths[run]) : 0;
      end_[run] = end;
      winner_[leaves_ + run] = static_cast<std::uint32_t>(run);
      read_key(run);
    }
    for (std::size_t node = leaves_ - 1; node > 0; --node)
      play(node);
  }

  /// The run of the least point, which is passed by.
  std::uint32_t take() {
    const std::uint32_t run = winner_[1];
    ++next_[run];
    read_key(run);
    for (std::size_t node = (leaves_ + run) / 2; node > 0; node /= 2)
      play(node);
    return run;
  }

private:
  /// Above the keys of all finite numbers.
  static constexpr std::uint64_t exhausted = std::numeric_limits<std::uint64_t>::max();

  void read_key(std::size_t run) {
    key_[run] = next_[run] < end_[run] ? ordered_bits(across(points_[next_[run]], axis_)) : exhausted;
  }
  void play(std::size_t node) {
    const std::uint32_t left = winner_[2 * node];
    const std::uint32_t right = winner_[2 * node + 1];
    bool right_wins = key_[right] < key_[left];
    if (key_[right] == key_[left] && key_[right] != exhausted) [[unlikely]]
      right_wins = along(points_[next_[right]], axis_) < along(points_[next_[left]], axis_);
    winner_[node] = right_wins ? right : left;
  }

  std::span<const Point> points_;
  Axis axis_;
  std::size_t leaves_;
  std::vector<std::uint64_t> key_;
  std::vector<std::size_t> next_;
  std::vector<std::size_t> end_;
  std::vector<std::uint32_t> winner_;
};

/// True if no run begins before the one in front of it ends.
bool ascends_as_it_lies(std::span<const Point> points, std::span<const std::int64_t> lengths, Axis axis) {
  std::size_t begin = 0;
  for (const std::int64_t length : lengths) {
    if (length > 0 && begin > 0 && TotalOrder{axis}(points[begin], points[begin - 1]))
      return false;
    begin += static_cast<std::size_t>(length);
  }
  return true;
}

} // namespace

std::vector<std::uint32_t> merge_order(std::span<const Point> points, std::span<const std::int64_t> lengths,
                                       Axis axis) {
  if (ascends_as_it_lies(points, lengths, axis))
    return {};
  WinnerTree tree(points, lengths, axis);
  std::vector<std::uint32_t> order(points.size());
  for (std::uint32_t &run : order)
    run = tree.take();
  return order;
}

} // namespace dovetail
