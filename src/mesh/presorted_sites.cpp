#include "presorted_sites.hpp"

#include "dovetail/base/huge_pages.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <numeric>

namespace dovetail {
namespace {

std::size_t index(LocalIndex i) { return static_cast<std::size_t>(i); }

struct Keyed {
  std::uint64_t key;
  LocalIndex site;
};

/// In the order of the doubles; 0.0 and -0.0 do not both occur.
std::uint64_t ordered_bits(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  return bits >> 63 != 0 ? ~bits : bits | std::uint64_t{1} << 63;
}

/// Sorts sites by one axis and the other.
class AxisSort {
public:
  explicit AxisSort(std::span<const Point> sites) : sites_(sites) {}

  std::vector<LocalIndex> sorted(Axis axis) {
    std::vector<LocalIndex> order(sites_.size());
    std::iota(order.begin(), order.end(), 0);
    if (std::ranges::is_sorted(sites_, TotalOrder{axis}))
      return order;
    reserve_huge(records_, sites_.size());
    records_.clear();
    for (const LocalIndex v : order)
      records_.push_back({ordered_bits(across(sites_[index(v)], axis)), v});
    settle_ties(axis, sort_by_digits());
    std::ranges::transform(records_, order.begin(), &Keyed::site);
    return order;
  }

private:
  static constexpr int bits = 11;
  static constexpr std::size_t values = std::size_t{1} << bits;

  /// By the leading bits in which keys differ, digit after digit from the last to the first: so many that few
  /// sites share them, unless they are crowded. Returns how many bits of a key are not looked at.
  int sort_by_digits() {
    std::uint64_t any = 0, all = ~std::uint64_t{0};
    for (const Keyed &record : records_) {
      any |= record.key;
      all &= record.key;
    }
    const auto differing = static_cast<int>(std::bit_width(any ^ all));
    const int wanted = std::min(differing, static_cast<int>(std::bit_width(records_.size())) + 12);
    const int digits = (wanted + bits - 1) / bits;
    const int unread = std::max(0, differing - digits * bits);
    const auto digit = [&](std::uint64_t key, int place) {
      return (key >> (unread + place * bits)) & (values - 1);
    };
    std::vector<std::array<std::uint32_t, values>> ends(static_cast<std::size_t>(digits));
    for (const Keyed &record : records_)
      for (int place = 0; place < digits; ++place)
        ++ends[static_cast<std::size_t>(place)][digit(record.key, place)];
    reserve_huge(spare_, records_.size());
    spare_.resize(records_.size());
    for (int place = 0; place < digits; ++place) {
      auto &end = ends[static_cast<std::size_t>(place)];
      std::exclusive_scan(end.begin(), end.end(), end.begin(), std::uint32_t{0});
      for (const Keyed &record : records_)
        spare_[end[digit(record.key, place)]++] = record;
      records_.swap(spare_);
    }
    return unread;
  }

  /// What the digits do not tell apart is compared.
  void settle_ties(Axis axis, int unread) {
    for (std::size_t begin = 0, end = 0; begin < records_.size(); begin = end) {
      const std::uint64_t key = records_[begin].key >> unread;
      for (end = begin + 1; end < records_.size() && records_[end].key >> unread == key;)
        ++end;
      if (end - begin > 1)
        std::ranges::sort(std::span(records_).subspan(begin, end - begin), TotalOrder{axis},
                          [&](const Keyed &record) { return sites_[index(record.site)]; });
    }
  }

  std::span<const Point> sites_;
  std::vector<Keyed> records_, spare_;
};

/// Cells of a square grid over the ranks by x and by y, of a few sites each however the sites are
/// distributed, in Morton's order: every square of 2^k by 2^k cells is one stretch of numbers.
class Cells {
public:
  explicit Cells(std::size_t sites) {
    const auto bits = static_cast<int>(std::bit_width(sites));
    bits_ = std::clamp(bits / 2 - 1, 0, 10);
    shift_ = bits - bits_;
  }
  std::size_t count() const { return std::size_t{1} << (2 * bits_); }
  std::size_t of(std::size_t x_rank, std::size_t y_rank) const {
    return spread(x_rank >> shift_) << 1 | spread(y_rank >> shift_);
  }

private:
  /// Puts a zero before every bit of a number of up to sixteen.
  static std::size_t spread(std::size_t v) {
    v = (v | v << 8) & 0x00ff00ff;
    v = (v | v << 4) & 0x0f0f0f0f;
    v = (v | v << 2) & 0x33333333;
    return (v | v << 1) & 0x55555555;
  }
  int bits_, shift_;
};

} // namespace

PresortedSites presort(std::span<const Point> sites) {
  const std::size_t n = sites.size();
  std::vector<LocalIndex> sorted_by_x, sorted_by_y;
  {
    AxisSort sort(sites);
    sorted_by_x = sort.sorted(Axis::x);
    sorted_by_y = sort.sorted(Axis::y);
  }
  PresortedSites result;
  auto &[by_x, by_y] = result.order;
  auto &[x_rank, y_rank] = result.rank;
  reserve_huge(result.point, n);
  result.point.resize(n);
  result.original.resize(n);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    result.order[axis].resize(n);
    result.rank[axis].resize(n);
  }
  for (std::size_t rank = 0; rank < n; ++rank)
    y_rank[index(sorted_by_y[rank])] = static_cast<LocalIndex>(rank); // by original number, for now
  const Cells cells(n);
  std::vector<std::size_t> end(cells.count(), 0);
  for (std::size_t rank = 0; rank < n; ++rank) {
    by_x[rank].other_rank = y_rank[index(sorted_by_x[rank])];
    ++end[cells.of(rank, index(by_x[rank].other_rank))];
  }
  std::exclusive_scan(end.begin(), end.end(), end.begin(), std::size_t{0});
  for (std::size_t rank = 0; rank < n; ++rank) {
    const LocalIndex site = sorted_by_x[rank], other_rank = by_x[rank].other_rank;
    const std::size_t v = end[cells.of(rank, index(other_rank))]++;
    result.point[v] = sites[index(site)];
    result.original[v] = site;
    x_rank[v] = static_cast<LocalIndex>(rank);
    y_rank[v] = other_rank;
    by_x[rank].site = static_cast<LocalIndex>(v);
    by_y[index(other_rank)] = {static_cast<LocalIndex>(v), static_cast<LocalIndex>(rank)};
  }
  return result;
}

} // namespace dovetail
