#include "box_splitting.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <ranges>
#include <utility>

namespace dovetail {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// From so many interior sites on, a strip of them is looked at first.
constexpr std::size_t worth_a_strip = 48;

/// Worth to be sorted, or looked up one by one, rather than found by looking at all.
constexpr bool are_few(std::size_t some, std::size_t all) { return 16 * some < all; }

std::size_t index(LocalIndex i) { return static_cast<std::size_t>(i); }
std::size_t index(Axis axis) { return static_cast<std::size_t>(axis); }
constexpr Axis other(Axis axis) { return axis == Axis::x ? Axis::y : Axis::x; }

} // namespace

BoxSplitting::BoxSplitting(PresortedSites &&sites)
    : sites_(std::move(sites)), is_interior_(sites_.point.size(), true), scratch_(sites_.point.size()) {}

/// The hull on one side of all sites, from the lowest over the farthest to the highest; outside of it
/// orientations are `outside`. What is inside of the two chords is seen to be so, and left out, at once.
std::vector<LocalIndex> BoxSplitting::hull_side(std::array<LocalIndex, 3> corners,
                                                std::span<const RankedSite> between, Sign outside) const {
  const Point lowest = point(corners[0]), farthest = point(corners[1]), highest = point(corners[2]);
  const Sign inside = outside == Sign::positive ? Sign::negative : Sign::positive;
  std::vector<LocalIndex> chain{corners[0]};
  const auto extend = [&](LocalIndex v) {
    while (chain.size() >= 2 &&
           orientation(point(chain[chain.size() - 2]), point(chain.back()), point(v)) == outside)
      chain.pop_back();
    chain.push_back(v);
  };
  const auto extend_by = [&](auto begin, auto end, Point from, Point to) {
    for (; begin != end; ++begin)
      if (filter::orientation(from, to, point(begin->site)) != inside)
        extend(begin->site);
  };
  const auto middle = std::ranges::upper_bound(
      between, farthest.y, {}, [&](const RankedSite &ranked) { return point(ranked.site).y; });
  extend_by(between.begin(), middle, lowest, farthest);
  extend_by(middle, between.end(), farthest, highest);
  if (corners[2] != corners[0])
    extend(corners[2]);
  return chain;
}

Box BoxSplitting::whole() {
  const std::span<const RankedSite> by_x = sites_.order[0], by_y = sites_.order[1];
  const auto y = [&](std::size_t rank) { return point(by_y[rank].site).y; };
  const std::size_t n = by_y.size();
  std::size_t lowest = 0, highest = n; // behind the lowest row, and where the highest begins
  while (lowest < n && y(lowest) == y(0))
    ++lowest;
  while (highest > 0 && y(highest - 1) == y(n - 1))
    --highest;
  const std::span between = lowest < highest ? by_y.subspan(lowest, highest - lowest) : by_y.first(0);
  const auto row = [](std::span<const RankedSite> ranked) {
    std::vector<LocalIndex> chain;
    std::ranges::transform(ranked, std::back_inserter(chain), &RankedSite::site);
    return chain;
  };
  Box box{};
  const auto lay = [&](Axis axis, std::size_t end, const std::vector<LocalIndex> &chain) {
    box.sides[index(axis)][end] = {end == 0 ? -infinite : infinite,
                                   {stack_.size(), stack_.size() + chain.size()}};
    stack_.insert(stack_.end(), chain.begin(), chain.end());
    for (const LocalIndex v : chain)
      is_interior_[index(v)] = false;
  };
  lay(Axis::y, 0, row(by_y.first(lowest)));
  lay(Axis::y, 1, row(by_y.subspan(highest)));
  lay(Axis::x, 0, hull_side({by_y[0].site, by_x.front().site, by_y[highest].site}, between, Sign::positive));
  lay(Axis::x, 1,
      hull_side({by_y[lowest - 1].site, by_x.back().site, by_y[n - 1].site}, between, Sign::negative));
  for (auto &order : sites_.order)
    std::erase_if(order, [&](const RankedSite &ranked) { return !is_interior_[index(ranked.site)]; });
  box.end = sites_.order[0].size();
  return box;
}

/// From the first to behind the last; empty for none.
BoxSplitting::Ranks BoxSplitting::ranks(std::span<const RankedSite> sites, Axis axis) const {
  const auto rank = [&](const RankedSite &ranked) { return sites_.rank[index(axis)][index(ranked.site)]; };
  return sites.empty() ? Ranks{0, 0} : Ranks{rank(sites.front()), rank(sites.back()) + 1};
}

SplitLine BoxSplitting::middle(const Box &box) const {
  const auto extent = [&](Axis axis) {
    const std::span order = interior(box, axis);
    return across(point(order.back().site), axis) - across(point(order.front().site), axis);
  };
  const Axis axis = extent(Axis::y) > extent(Axis::x) ? Axis::y : Axis::x;
  return {across(point(interior(box, axis)[(box.interior() - 1) / 2].site), axis), axis};
}

/// Distances from a point of a line have one minimum on its path. From far out all that counts is how far out
/// a site is, and of two as far how near to the split line.
std::size_t BoxSplitting::nearest(const Side &side, SplitLine line) const {
  const Point corner =
      line.axis == Axis::x ? Point{line.position, side.line} : Point{side.line, line.position};
  const auto comes_nearer = [&](Point next, Point here) {
    if (!std::isinf(side.line))
      return nearer(next, here, corner);
    const double a = along(next, line.axis), b = along(here, line.axis);
    return a != b ? (a < b) == (side.line < 0) : nearer(next, here, line);
  };
  std::size_t place = side.chain.begin;
  while (place + 1 < side.chain.end && comes_nearer(point(stack_[place + 1]), point(stack_[place])))
    ++place;
  return place;
}

Ends BoxSplitting::ends(const Box &box, SplitLine line) const {
  const auto &[low, high] = box.sides[index(other(line.axis))];
  return {nearest(low, line), nearest(high, line)};
}

Chain BoxSplitting::path(const Box &box, SplitLine line, Ends ends) {
  const LocalIndex first = stack_[ends.low], last = stack_[ends.high];
  return line.axis == Axis::x ? path_across<Axis::x>(box, line.position, first, last)
                              : path_across<Axis::y>(box, line.position, first, last);
}

/// The lower hull of the lifted sites, one after another along the line. Of sites at the same place along it
/// only the nearest can stay.
template <Axis axis> void BoxSplitting::extend_hull(HullSite next, double m) {
  const SplitLine line{m, axis};
  if (!hull_.empty() && along(hull_.back().point, axis) == along(next.point, axis)) {
    if (!nearer(next.point, hull_.back().point, line))
      return;
    hull_.pop_back();
  }
  while (hull_.size() >= 2 &&
         hull_turn(hull_[hull_.size() - 2].point, hull_.back().point, next.point, line) != Sign::positive)
    hull_.pop_back();
  hull_.push_back(next);
}

/// The path of both ends and of a strip along the line, in hull_. The few sites of a strip in a large box are
/// sorted anew, those in a small box are found in the order that there is.
template <Axis axis>
BoxSplitting::Strip BoxSplitting::approximate(const Box &box, double m, HullSite first, HullSite last) {
  hull_.assign(1, first);
  const std::size_t n = box.interior();
  Strip strip{n / 2, n / 2};
  if (n >= worth_a_strip) {
    const auto half = static_cast<std::size_t>(1.5 * std::sqrt(static_cast<double>(n)));
    strip = {n / 2 - half, n / 2 + half};
    const std::span in_strip = interior(box, axis).subspan(strip.begin, strip.end - strip.begin);
    std::size_t found = 0;
    if (are_few(in_strip.size(), n)) {
      found = in_strip.size();
      std::ranges::copy(in_strip, scratch_.begin());
      std::ranges::sort(std::span(scratch_).first(found), {}, &RankedSite::other_rank);
    } else {
      const auto [begin, end] = ranks(in_strip, axis);
      for (const RankedSite &ranked : interior(box, other(axis))) {
        scratch_[found] = ranked;
        found += static_cast<std::size_t>((ranked.other_rank >= begin) & (ranked.other_rank < end));
      }
    }
    for (const RankedSite &ranked : std::span(scratch_).first(found)) {
      const Point p = point(ranked.site);
      if (along(p, axis) > along(first.point, axis) && along(p, axis) < along(last.point, axis))
        extend_hull<axis>({p, ranked.site}, m);
    }
  }
  extend_hull<axis>(last, m);
  return strip;
}

/// Lifted, with the beginning of a chord as the origin along the line: squares of distances are at most
/// `size` between its ends, and 2^-48 of that is far more than all roundings. What is too large or too small
/// for such numbers passes: a comparison with NaN is false, and so no slope is infinite.
template <Axis axis> void BoxSplitting::set_chords(double m) {
  chords_.clear();
  double reach = 0;
  for (std::size_t i = 0; i + 1 < hull_.size(); ++i) {
    const double low = along(hull_[i].point, axis), high_end = along(hull_[i + 1].point, axis);
    const double low_distance = across(hull_[i].point, axis) - m;
    const double high_distance = across(hull_[i + 1].point, axis) - m;
    const double length = high_end - low;
    const double low_square = low_distance * low_distance, high_square = high_distance * high_distance;
    const double size = low_square + high_square + length * length;
    const double farthest = std::max(low_square, high_square) + length * length / 4;
    const double slope = (high_square - low_square + length * length) / length;
    chords_.push_back({low, high_end, low_square + (0x1p-48 * size + 0x1p-1000),
                       std::isfinite(slope) ? slope : std::numeric_limits<double>::quiet_NaN(),
                       farthest * (1 + 0x1p-40) + 0x1p-1000});
    reach = std::max(reach, chords_.back().reach_squared);
  }
  reach_squared_ = reach;
}

/// Finds what may be on the path besides the approximate one, in no order: what lies on or below a chord.
template <Axis axis>
std::span<BoxSplitting::HullSite> BoxSplitting::find_others(const Box &box, double m, Strip strip) {
  std::size_t found = 0;
  for (const auto &pair : box.sides)
    for (const Side &side : pair)
      found = consider<axis>(sites(side.chain), m, found);

  // Of the interior, what is outside of the strip and beside a chord that reaches that far.
  const std::span by_line = interior(box, axis), along_line = interior(box, other(axis));
  const auto distance = [&](std::size_t place) {
    return std::fabs(across(point(by_line[place].site), axis) - m);
  };
  const double outside = std::min(strip.begin > 0 ? distance(strip.begin - 1) : infinite,
                                  strip.end < by_line.size() ? distance(strip.end) : infinite);
  const auto [begin, end] = ranks(by_line.subspan(strip.begin, strip.end - strip.begin), axis);
  const auto position = [&](const RankedSite &ranked) { return along(point(ranked.site), axis); };
  for (const Chord &chord : chords_)
    if (!(chord.reach_squared < outside * outside)) {
      const auto first = std::ranges::upper_bound(along_line, chord.low, {}, position);
      const auto last = std::ranges::upper_bound(first, along_line.end(), chord.high, {}, position);
      const std::span beside(first, last);
      make_room(found + beside.size());
      for (const RankedSite &ranked : beside) {
        const Point p = point(ranked.site);
        others_[found] = {p, ranked.site};
        found += static_cast<std::size_t>(((ranked.other_rank < begin) | (ranked.other_rank >= end)) &
                                          chord.holds<axis>(p, m));
      }
    }
  return std::span(others_).first(found);
}

void BoxSplitting::make_room(std::size_t sites) {
  if (others_.size() < sites)
    others_.resize(2 * sites);
}

/// Adds those of some sites, in any order, that lie on or below a chord to what is found so far.
template <Axis axis>
std::size_t BoxSplitting::consider(std::span<const LocalIndex> candidates, double m, std::size_t found) {
  const double low = chords_.front().low, high = chords_.back().high;
  const bool one_chord = chords_.size() == 1;
  make_room(found + candidates.size());
  for (const LocalIndex v : candidates) {
    const Point p = point(v);
    const double distance = across(p, axis) - m, height = along(p, axis);
    const bool between = (height > low) & (height < high);
    others_[found] = {p, v};
    if (one_chord)
      found +=
          static_cast<std::size_t>(between) & static_cast<std::size_t>(chords_.front().holds<axis>(p, m));
    else if (between && !(distance * distance > reach_squared_)) {
      const auto chord = std::ranges::lower_bound(chords_, height, {}, &Chord::high);
      found += chord->template holds<axis>(p, m) ? 1U : 0U;
    }
  }
  return found;
}

template <Axis axis>
Chain BoxSplitting::path_across(const Box &box, double m, LocalIndex first, LocalIndex last) {
  const std::size_t begin = stack_.size();
  if (first == last) {
    stack_.push_back(first);
    return {begin, begin + 1};
  }
  const Strip strip = approximate<axis>(box, m, {point(first), first}, {point(last), last});
  set_chords<axis>(m);
  if (const std::span others = find_others<axis>(box, m, strip); !others.empty()) {
    const auto place = [](const HullSite &site) { return along(site.point, axis); };
    std::ranges::sort(others, {}, place);
    std::swap(approximate_, hull_);
    hull_.clear();
    auto next = others.begin();
    for (const HullSite &site : approximate_) {
      for (; next != others.end() && place(*next) < place(site); ++next)
        extend_hull<axis>(*next, m);
      extend_hull<axis>(site, m);
    }
  }
  for (const HullSite &site : hull_)
    stack_.push_back(site.site);
  return {begin, stack_.size()};
}

std::span<const LocalIndex> BoxSplitting::walk_around(const Box &box) {
  walk_.clear();
  const auto add = [&](LocalIndex v) {
    if (walk_.empty() || walk_.back() != v)
      walk_.push_back(v);
  };
  const auto &[across_x, across_y] = box.sides;
  std::ranges::for_each(sites(across_y[0].chain), add);
  std::ranges::for_each(sites(across_x[1].chain), add);
  std::ranges::for_each(sites(across_y[1].chain) | std::views::reverse, add);
  std::ranges::for_each(sites(across_x[0].chain) | std::views::reverse, add);
  if (walk_.size() > 1 && walk_.front() == walk_.back())
    walk_.pop_back();
  return walk_;
}

Halves BoxSplitting::divide(const Box &box, SplitLine line, Ends ends, Chain path) {
  const std::size_t cut = index(line.axis), uncut = 1 - cut;
  Halves halves{box, box};
  halves.low.sides[cut][1] = halves.high.sides[cut][0] = {line.position, path};
  for (std::size_t end = 0; end < 2; ++end) {
    const std::size_t place = end == 0 ? ends.low : ends.high;
    halves.low.sides[uncut][end].chain.end = place + 1;
    halves.high.sides[uncut][end].chain.begin = place;
  }
  leaving_.clear();
  for (const LocalIndex v : sites(path))
    if (is_interior_[index(v)]) {
      is_interior_[index(v)] = false;
      leaving_.push_back(v);
    }

  // The order across the line falls apart by itself, behind the last site at the line ...
  const std::span by_line = std::span(sites_.order[cut]).subspan(box.begin, box.interior());
  std::size_t middle = (by_line.size() + 1) / 2;
  while (middle < by_line.size() && across(point(by_line[middle].site), line.axis) == line.position)
    ++middle;
  const LocalIndex last_low = sites_.rank[cut][index(by_line[middle - 1].site)];

  // ... and the order along the line, in which the path ascends too, is divided by rank.
  const std::span along_line = std::span(sites_.order[uncut]).subspan(box.begin, box.interior());
  leaving_.push_back(none);
  const LocalIndex *next_leaving = leaving_.data();
  std::size_t low_count = 0, high_count = 0;
  for (const RankedSite ranked : along_line) {
    const bool leaves = ranked.site == *next_leaving, is_low = ranked.other_rank <= last_low;
    next_leaving += leaves ? 1 : 0;
    along_line[low_count] = ranked;
    scratch_[high_count] = ranked;
    low_count += static_cast<std::size_t>(is_low & !leaves);
    high_count += static_cast<std::size_t>(!is_low & !leaves);
  }
  std::copy_n(scratch_.begin(), high_count, along_line.begin() + static_cast<std::ptrdiff_t>(low_count));
  assert(low_count + high_count < by_line.size()); // the median is on the path

  leaving_.pop_back();
  remove(by_line, line.axis);
  halves.low.end = halves.high.begin = box.begin + low_count;
  halves.high.end = halves.high.begin + high_count;
  return halves;
}

/// Takes the leaving sites out of an order, and closes the gaps.
void BoxSplitting::remove(std::span<RankedSite> order, Axis axis) {
  const auto rank = [&](LocalIndex v) { return sites_.rank[index(axis)][index(v)]; };
  std::ranges::sort(leaving_, {}, rank);
  if (are_few(leaving_.size(), order.size())) {
    auto from = order.begin(), to = from;
    for (const LocalIndex v : leaving_) {
      const auto place =
          std::lower_bound(from, order.end(), rank(v),
                           [&](const RankedSite &ranked, LocalIndex r) { return rank(ranked.site) < r; });
      to = std::move(from, place, to);
      from = place + 1;
    }
    std::move(from, order.end(), to);
    return;
  }
  leaving_.push_back(none);
  const LocalIndex *next_leaving = leaving_.data();
  std::size_t count = 0;
  for (const RankedSite ranked : order) {
    const bool leaves = ranked.site == *next_leaving;
    next_leaving += leaves ? 1 : 0;
    order[count] = ranked;
    count += leaves ? 0U : 1U;
  }
}

} // namespace dovetail
