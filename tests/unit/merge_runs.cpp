// Merging sorted runs, against a stable sort of all of them.
#include "distributed/merge_runs.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

namespace dovetail {
namespace {

/// Runs of random lengths, points of a lattice with `side` columns and rows: small ones give equal points.
void expect_merged(std::mt19937 &random, std::size_t runs, unsigned longest, unsigned side, Axis axis) {
  std::vector<Point> arrived;
  std::vector<std::int64_t> lengths;
  for (std::size_t run = 0; run < runs; ++run) {
    const std::size_t begin = arrived.size(), length = random() % (longest + 1);
    for (std::size_t i = 0; i < length; ++i)
      arrived.push_back({static_cast<double>(random() % side), static_cast<double>(random() % side)});
    std::sort(arrived.begin() + static_cast<std::ptrdiff_t>(begin), arrived.end(), TotalOrder{axis});
    lengths.push_back(static_cast<std::int64_t>(length));
  }
  std::vector<std::int64_t> column(arrived.size()), merged_column(arrived.size());
  std::iota(column.begin(), column.end(), 0);
  std::vector<std::int64_t> order = column;
  std::ranges::stable_sort(order, TotalOrder{axis},
                           [&](std::int64_t i) { return arrived[static_cast<std::size_t>(i)]; });
  std::vector<Point> expected;
  for (const std::int64_t i : order)
    expected.push_back(arrived[static_cast<std::size_t>(i)]);

  std::vector<Point> merged(arrived.size());
  const std::vector<MergeRound> rounds = merge_points(arrived, lengths, axis, merged);
  EXPECT_EQ(merged, expected) << runs << " runs of up to " << longest;
  merge_column<std::int64_t>(rounds, column, merged_column);
  EXPECT_EQ(merged_column, order) << runs << " runs of up to " << longest;
}

TEST(MergeRuns, IsAStableSort) {
  std::mt19937 random(1);
  for (const Axis axis : {Axis::x, Axis::y})
    for (const std::size_t runs :
         {std::size_t{1}, std::size_t{2}, std::size_t{3}, std::size_t{8}, std::size_t{13}})
      for (const unsigned longest : {0U, 1U, 2U, 5U, 40U, 1000U})
        for (const unsigned side : {1U, 3U, 1000U})
          expect_merged(random, runs, longest, side, axis);
}

TEST(MergeRuns, DecidesNothingWhereRunsFollowEachOther) {
  std::vector<Point> arrived{{0, 0}, {0, 1}, {0, 1}, {2, 0}}, merged(4);
  const std::vector<Point> expected = arrived;
  const std::vector<std::int64_t> lengths{2, 0, 2};
  EXPECT_TRUE(merge_points(arrived, lengths, Axis::x, merged).empty());
  EXPECT_EQ(merged, expected);
}

} // namespace
} // namespace dovetail
