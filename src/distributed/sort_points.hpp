/// What one rank does with its points on the way into slabs: sort them, and merge equal ones. Local.
#pragma once

#include "dovetail/base/point_table.hpp"
#include "dovetail/base/progress.hpp"
#include "dovetail/distributed/slabs.hpp"

#include <bit>
#include <cstdint>
#include <vector>

namespace dovetail {

/// Unsigned integers in the order of finite doubles (and of no -0.0), and back.
inline std::uint64_t ordered_bits(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const std::uint64_t sign = std::uint64_t{1} << 63;
  return (bits & sign) != 0 ? ~bits : bits | sign;
}
inline double from_ordered_bits(std::uint64_t ordered) {
  const std::uint64_t sign = std::uint64_t{1} << 63;
  return std::bit_cast<double>((ordered & sign) != 0 ? ordered ^ sign : ~ordered);
}

/// Sorts the table by the total order; equal points end in any order. Returns at once where the points ascend
/// already.
///
/// Radix sort from the highest differing bit of `across`, then ties by `along`: the first pass spreads
/// 16-byte records of key and position over buckets that fit into the cache, the later ones stay there, and
/// every column is permuted through the memory of the records. Memory: 16 bytes a point and one bucket.
void sort_points(PointTable &table, Axis axis, const Progress &progress);

/// A point that gave way to an equal one.
struct MergedPoint {
  Point point;
  GlobalIndex input_index;
  double z; ///< 0 without a z
};

/// In a sorted table, keeps one of equal points by the rule (DuplicateRule::error as first), still sorted,
/// and appends the others to `merged`, sorted by position.
void merge_equal_points(PointTable &table, DuplicateRule rule, std::vector<MergedPoint> &merged);

/// The "z" of a table's points, or null.
const std::vector<double> *heights_of(const PointTable &table);

} // namespace dovetail
