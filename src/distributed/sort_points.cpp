#include "sort_points.hpp"

#include "dovetail/base/huge_pages.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <memory>
#include <span>

namespace dovetail {
namespace {

/// A point's key and its position in the table.
struct Record {
  std::uint64_t key;
  std::uint64_t position;
};

/// Where records of one length go while others are read.
using Buffer = std::unique_ptr<Record[]>;

constexpr std::size_t insertion_limit = 16;
constexpr int digit_bits = 11;

void insertion_sort(Record *records, std::size_t count) {
  for (std::size_t i = 1; i < count; ++i) {
    const Record moving = records[i];
    std::size_t j = i;
    for (; j > 0 && moving.key < records[j - 1].key; --j)
      records[j] = records[j - 1];
    records[j] = moving;
  }
}

/// Sorts by key, from the highest bit in which the keys differ; as many digits at a time as leaves a few
/// records in each bucket. The result is in `data`, or in `spare` if wanted there; both have room for all.
void radix_sort(Record *data, Record *spare, std::size_t count, bool into_spare) {
  const auto hand_over = [&] {
    if (into_spare)
      std::copy(data, data + count, spare);
  };
  if (count <= insertion_limit) {
    insertion_sort(data, count);
    return hand_over();
  }
  std::uint64_t any = 0;
  std::uint64_t all = ~std::uint64_t{0};
  for (std::size_t i = 0; i < count; ++i) {
    any |= data[i].key;
    all &= data[i].key;
  }
  const int differing = static_cast<int>(std::bit_width(any ^ all));
  if (differing == 0)
    return hand_over();
  const int bits = std::min({digit_bits, differing, static_cast<int>(std::bit_width(count)) - 2});
  const int shift = differing - bits;
  const std::size_t buckets = std::size_t{1} << bits;
  const auto digit = [&](const Record &record) { return (record.key >> shift) & (buckets - 1); };

  std::array<std::size_t, (std::size_t{1} << digit_bits) + 1> ends;
  std::fill_n(ends.begin(), buckets + 1, 0);
  for (std::size_t i = 0; i < count; ++i)
    ++ends[digit(data[i]) + 1];
  for (std::size_t b = 0; b < buckets; ++b)
    ends[b + 1] += ends[b];
  for (std::size_t i = 0; i < count; ++i)
    spare[ends[digit(data[i])]++] = data[i];
  for (std::size_t b = 0, begin = 0; b < buckets; begin = ends[b++])
    if (ends[b] > begin)
      radix_sort(spare + begin, data + begin, ends[b] - begin, !into_spare);
}

/// Sorts a bucket that is sorted by `across` by `along` among equals.
void settle_ties(std::span<Record> bucket, Record *spare, std::span<const Point> points, Axis axis) {
  for (std::size_t begin = 0, end = 0; begin < bucket.size(); begin = end) {
    const std::uint64_t key = bucket[begin].key;
    for (end = begin + 1; end < bucket.size() && bucket[end].key == key;)
      ++end;
    if (end - begin == 1)
      continue;
    const auto run = bucket.subspan(begin, end - begin);
    for (Record &record : run)
      record.key = ordered_bits(along(points[record.position], axis));
    radix_sort(run.data(), spare, run.size(), false);
    for (Record &record : run)
      record.key = key;
  }
}

/// The first pass: records by buckets in ascending order, not sorted inside.
struct Buckets {
  Buffer records;
  std::vector<std::size_t> ends;
  std::size_t largest = 0;
};

Buckets spread(std::span<const Point> points, Axis axis) {
  const auto key_of = [&](Point p) { return ordered_bits(across(p, axis)); };
  std::uint64_t lowest = ~std::uint64_t{0};
  std::uint64_t highest = 0;
  for (const Point &p : points) {
    assert(!(p.x == 0 && std::signbit(p.x)) && !(p.y == 0 && std::signbit(p.y)));
    lowest = std::min(lowest, key_of(p));
    highest = std::max(highest, key_of(p));
  }
  // Sixteen bits below the common ones tell apart even what the exponents of a heavy tail bunch together;
  // neighbouring digits share a bucket until it is worth one: about 2 MiB of cache for two copies of it, but
  // not more buckets than a scattering pass can keep open.
  constexpr int bits = 16;
  const int shift = std::max(0, static_cast<int>(std::bit_width(lowest ^ highest)) - bits);
  const auto digit_of = [&](Point p) { return (key_of(p) >> shift) & ((1u << bits) - 1); };
  std::vector<std::size_t> digits(std::size_t{1} << bits, 0);
  for (const Point &p : points)
    ++digits[digit_of(p)];

  const std::size_t worth = std::max<std::size_t>(16384, points.size() / 1024);
  std::vector<std::uint16_t> bucket_of(digits.size());
  Buckets buckets;
  std::vector<std::size_t> begins;
  std::size_t end = 0;
  for (std::size_t d = 0; d < digits.size(); ++d) {
    if (begins.empty() || (end - begins.back() + digits[d] > worth && end > begins.back()))
      begins.push_back(end);
    bucket_of[d] = static_cast<std::uint16_t>(begins.size() - 1);
    end += digits[d];
    buckets.largest = std::max(buckets.largest, end - begins.back());
  }

  buckets.records = make_huge_for_overwrite<Record>(points.size());
  buckets.ends = std::move(begins);
  for (std::size_t i = 0; i < points.size(); ++i)
    buckets.records[buckets.ends[bucket_of[digit_of(points[i])]]++] = {key_of(points[i]), i};
  return buckets;
}

/// points[i] becomes points[records[i].position]; its `across` is the key, so only `along` is fetched, and
/// the places of `across` are free to take it.
void permute_points(std::span<Point> points, std::span<const Record> records, Axis axis) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double fetched = along(points[records[i].position], axis);
    (axis == Axis::x ? points[i].x : points[i].y) = fetched;
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double a = from_ordered_bits(records[i].key);
    const double b = across(points[i], axis);
    points[i] = axis == Axis::x ? Point{a, b} : Point{b, a};
  }
}

/// Permutes through the keys, which are lost.
template <class Value> void permute_column(std::span<Value> column, std::span<Record> records) {
  for (Record &record : records)
    record.key = std::bit_cast<std::uint64_t>(column[record.position]);
  for (std::size_t i = 0; i < column.size(); ++i)
    column[i] = std::bit_cast<Value>(records[i].key);
}

/// Consecutive numbers, such as those of points as they were read, need not be fetched.
void permute_input_index(std::span<GlobalIndex> column, std::span<Record> records) {
  const GlobalIndex first = column.front();
  if (std::adjacent_find(column.begin(), column.end(),
                         [](GlobalIndex a, GlobalIndex b) { return b != a + 1; }) != column.end())
    return permute_column(column, records);
  for (std::size_t i = 0; i < column.size(); ++i)
    column[i] = first + static_cast<GlobalIndex>(records[i].position);
}

} // namespace

void sort_points(PointTable &table, Axis axis, const Progress &progress) {
  const std::size_t count = table.points.size();
  if (std::is_sorted(table.points.begin(), table.points.end(), TotalOrder{axis}))
    return;
  const Buckets buckets = spread(table.points, axis);
  const std::span records(buckets.records.get(), count);
  {
    const auto spare = std::make_unique_for_overwrite<Record[]>(buckets.largest);
    std::size_t begin = 0;
    std::size_t reported = 0;
    for (const std::size_t end : buckets.ends) {
      radix_sort(&records[begin], spare.get(), end - begin, false);
      settle_ties(records.subspan(begin, end - begin), spare.get(), table.points, axis);
      begin = end;
      if (end - reported > count / 32) {
        report_progress(progress, "sort", static_cast<double>(end) / static_cast<double>(count));
        reported = end;
      }
    }
  }
  permute_points(table.points, records, axis);
  permute_input_index(table.input_index, records);
  for (Attribute &attribute : table.attributes)
    permute_column<double>(attribute.values, records);
}

const std::vector<double> *heights_of(const PointTable &table) {
  return !table.attributes.empty() && table.attributes.front().name == "z" ? &table.attributes.front().values
                                                                           : nullptr;
}

namespace {

/// Which of the equal points begin .. end - 1 represents them.
std::size_t representative(const PointTable &table, std::size_t begin, std::size_t end, DuplicateRule rule) {
  const std::vector<double> *z = heights_of(table);
  const bool compares_z = z != nullptr && (rule == DuplicateRule::lowest || rule == DuplicateRule::highest);
  for (std::size_t i = begin; compares_z && i < end; ++i)
    assert(!std::isnan((*z)[i])); // or the choice would depend on the order of the input
  const auto better = [&](std::size_t a, std::size_t b) {
    if (z != nullptr && rule == DuplicateRule::lowest && (*z)[a] != (*z)[b])
      return (*z)[a] < (*z)[b];
    if (z != nullptr && rule == DuplicateRule::highest && (*z)[a] != (*z)[b])
      return (*z)[a] > (*z)[b];
    return table.input_index[a] < table.input_index[b];
  };
  std::size_t best = begin;
  for (std::size_t i = begin + 1; i < end; ++i)
    if (better(i, best))
      best = i;
  return best;
}

} // namespace

void merge_equal_points(PointTable &table, DuplicateRule rule, std::vector<MergedPoint> &merged) {
  auto &points = table.points;
  const auto first_equal = std::adjacent_find(points.begin(), points.end());
  if (first_equal == points.end())
    return;
  const std::vector<double> *z = heights_of(table);
  auto kept = static_cast<std::size_t>(first_equal - points.begin());
  for (std::size_t begin = kept, end = 0; begin < points.size(); begin = end) {
    for (end = begin + 1; end < points.size() && points[end] == points[begin];)
      ++end;
    const std::size_t best = end - begin == 1 ? begin : representative(table, begin, end, rule);
    for (std::size_t i = begin; i < end; ++i)
      if (i != best)
        merged.push_back({points[i], table.input_index[i], z != nullptr ? (*z)[i] : 0.0});
    points[kept] = points[best];
    table.input_index[kept] = table.input_index[best];
    for (Attribute &attribute : table.attributes)
      attribute.values[kept] = attribute.values[best];
    ++kept;
  }
  points.resize(kept);
  table.input_index.resize(kept);
  for (Attribute &attribute : table.attributes)
    attribute.values.resize(kept);
}

} // namespace dovetail
