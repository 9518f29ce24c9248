/// Which of many strips can meet, without looking at all pairs. Private to mesh.
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <numeric>
#include <span>
#include <vector>

namespace dovetail {

/// A quadrangle between two upright lines: what lies on and above the line from the left to the right low,
/// and on and below that from the left to the right high.
struct Strip {
  double left_low, left_high, right_low, right_high;
};

/// The strips that a sweep has met, from left_low upwards. The next one lies wholly above them but for two
/// sorts: some reach up to it on the left; of the others, those that reach up to it on the right.
class StripsBelow {
public:
  explicit StripsBelow(std::span<const Strip> strips) : strips_(strips) {}
  void insert(std::size_t i) { reach_left_.push_back(i); }
  /// Of those met, all that the strip can meet.
  template <class Visit> void for_each_meeting(const Strip &strip, Visit visit) {
    std::erase_if(reach_left_, [&](std::size_t i) {
      const bool is_below = strips_[i].left_high < strip.left_low;
      if (is_below)
        by_right_high_.emplace(strips_[i].right_high, i);
      return is_below;
    });
    for (const std::size_t i : reach_left_)
      visit(i);
    for (auto i = by_right_high_.lower_bound(strip.right_low); i != by_right_high_.end(); ++i)
      visit(i->second);
  }

private:
  std::span<const Strip> strips_;
  std::vector<std::size_t> reach_left_;
  std::multimap<double, std::size_t> by_right_high_; ///< of all others
};

/// Calls visit(i, j) once for every pair of strips of which neither lies wholly above the other, but for
/// pairs among those from number `first_passive` on. O(n log n) and the visits. Nothing is not a number.
template <class Visit>
void for_each_meeting(std::span<const Strip> strips, std::size_t first_passive, Visit visit) {
  std::vector<std::size_t> upwards(strips.size());
  std::iota(upwards.begin(), upwards.end(), std::size_t{0});
  std::ranges::sort(upwards, {}, [&](std::size_t i) { return strips[i].left_low; });
  StripsBelow active(strips), passive(strips);
  for (const std::size_t j : upwards) {
    active.for_each_meeting(strips[j], [&](std::size_t i) { visit(i, j); });
    if (j < first_passive)
      passive.for_each_meeting(strips[j], [&](std::size_t i) { visit(i, j); });
    (j < first_passive ? active : passive).insert(j);
  }
}

} // namespace dovetail
