// Own slabs one by one, in memory or on disk.
#include "dovetail/base/huge_pages.hpp"
#include "dovetail/distributed/scratch_sites.hpp"
#include "dovetail/distributed/slabs.hpp"

#include <algorithm>
#include <bit>
#include <utility>

namespace dovetail {
namespace {

struct SiteRange {
  GlobalIndex begin, end;
  std::size_t count() const { return static_cast<std::size_t>(end - begin); }
};

SiteRange range_of_slab(const Slabs &slabs, int k) {
  const auto s = static_cast<std::size_t>(slabs.first_slab) + static_cast<std::size_t>(k);
  return {slabs.site_offsets[s], slabs.site_offsets[s + 1]};
}

template <class T>
std::vector<T> slice(const std::vector<T> &values, std::size_t begin, std::size_t count, std::size_t more) {
  std::vector<T> result;
  reserve_huge(result, count + more);
  const auto first = values.begin() + static_cast<std::ptrdiff_t>(begin);
  result.insert(result.end(), first, first + static_cast<std::ptrdiff_t>(count));
  return result;
}

/// Bits of the input index and the attributes of row `row`.
void append_record(const PointTable &table, std::size_t row, std::vector<std::uint64_t> &records) {
  records.push_back(std::bit_cast<std::uint64_t>(table.input_index[row]));
  for (const Attribute &attribute : table.attributes)
    records.push_back(std::bit_cast<std::uint64_t>(attribute.values[row]));
}

void clear_rows(PointTable &table) {
  table.points.clear();
  table.input_index.clear();
  for (Attribute &attribute : table.attributes)
    attribute.values.clear();
}

} // namespace

std::span<const Point> points_of_slab(const Slabs &slabs, int k, std::vector<Point> &buffer) {
  const SiteRange range = range_of_slab(slabs, k);
  if (!slabs.scratch)
    return std::span(slabs.sites.points)
        .subspan(static_cast<std::size_t>(range.begin - slabs.first_site()), range.count());
  buffer.resize(range.count());
  slabs.scratch->read_points(range.begin, buffer);
  return buffer;
}

PointTable table_of_slab(const Slabs &slabs, int k, std::size_t more) {
  const SiteRange range = range_of_slab(slabs, k);
  const PointTable &sites = slabs.sites;
  PointTable table;
  if (!slabs.scratch) {
    const auto begin = static_cast<std::size_t>(range.begin - slabs.first_site());
    table.points = slice(sites.points, begin, range.count(), more);
    table.input_index = slice(sites.input_index, begin, range.count(), more);
    for (const Attribute &attribute : sites.attributes)
      table.attributes.push_back({attribute.name, slice(attribute.values, begin, range.count(), more)});
    return table;
  }
  table.attributes = sites.attributes;
  reserve_huge(table.points, range.count() + more);
  reserve_huge(table.input_index, range.count() + more);
  for (Attribute &attribute : table.attributes)
    reserve_huge(attribute.values, range.count() + more);
  slabs.scratch->read(range.begin, range.end - range.begin, table);
  return table;
}

std::vector<Duplicate> duplicates_of_slab(const Slabs &slabs, int k) {
  const SiteRange range = range_of_slab(slabs, k);
  if (slabs.scratch)
    return slabs.scratch->read_duplicates(range.begin, range.end);
  const auto begin = std::ranges::lower_bound(slabs.duplicates, range.begin, {}, &Duplicate::site);
  return {begin, std::ranges::lower_bound(begin, slabs.duplicates.end(), range.end, {}, &Duplicate::site)};
}

std::vector<std::uint64_t> records_of_sites(const Slabs &slabs, std::span<const GlobalIndex> numbers) {
  std::vector<std::uint64_t> records;
  records.reserve(numbers.size() * (1 + slabs.sites.attributes.size()));
  if (!slabs.scratch) {
    for (const GlobalIndex number : numbers)
      append_record(slabs.sites, static_cast<std::size_t>(number - slabs.first_site()), records);
    return records;
  }
  // Sites of paths lie close to each other near the lines: what is near is read at once.
  constexpr GlobalIndex window = 4096;
  PointTable table;
  table.attributes = slabs.sites.attributes;
  for (std::size_t begin = 0, end = 0; begin < numbers.size(); begin = end) {
    while (end < numbers.size() && numbers[end] < numbers[begin] + window)
      ++end;
    clear_rows(table);
    slabs.scratch->read(numbers[begin], numbers[end - 1] - numbers[begin] + 1, table);
    for (std::size_t i = begin; i < end; ++i)
      append_record(table, static_cast<std::size_t>(numbers[i] - numbers[begin]), records);
  }
  return records;
}

} // namespace dovetail
