#include "dovetail/mesh/checksum.hpp"

#include <gtest/gtest.h>
#include <set>
#include <vector>

namespace dovetail {
namespace {

// The vectors come from a program in another language over exact integers.
TEST(Checksum, UnitRightTriangle) {
  const std::vector<Point> sites{{0, 0}, {1, 0}, {0, 1}};
  const std::vector<LocalIndex> corners{0, 1, 2};
  EXPECT_EQ(checksum_text(checksum_of_sites(sites) + checksum_of_triangles(sites, corners)),
            "4e844d15659c8cd7");
}

TEST(Checksum, LatticeOfThreeByThree) {
  std::vector<Point> sites;
  for (int x = 0; x < 3; ++x)
    for (int y = 0; y < 3; ++y)
      sites.push_back({static_cast<double>(x), static_cast<double>(y)});
  // The largest corner of every square has the highest lift: the diagonal joins the other two.
  std::vector<LocalIndex> corners;
  for (LocalIndex v : {0, 1, 3, 4})
    corners.insert(corners.end(), {v, v + 3, v + 1, v + 4, v + 1, v + 3});
  EXPECT_EQ(checksum_text(checksum_of_sites(sites) + checksum_of_triangles(sites, corners)),
            "c2fe32d69c2e0cf0");
}

TEST(Checksum, IsBlindToOrderOrientationAndSignOfZero) {
  const std::vector<Point> sites{{0, 0}, {1, 0}, {0, 1}, {1, 2}};
  const std::vector<Point> negative{{-0.0, 0}, {1, -0.0}, {-0.0, 1}, {1, 2}};
  const std::vector<LocalIndex> corners{0, 1, 2, 2, 1, 3};
  const std::vector<LocalIndex> other{3, 1, 2, 2, 1, 0};
  EXPECT_EQ(checksum_of_triangles(sites, corners), checksum_of_triangles(sites, other));
  EXPECT_EQ(checksum_of_triangles(sites, corners), checksum_of_triangles(negative, corners));
  EXPECT_EQ(checksum_of_sites(sites), checksum_of_sites(negative));
}

TEST(Checksum, PartsAddUp) {
  const std::vector<Point> sites{{0, 0}, {1, 0}, {0, 1}, {1, 2}};
  const std::vector<LocalIndex> corners{0, 1, 2, 2, 1, 3};
  const std::span<const LocalIndex> all(corners);
  EXPECT_EQ(checksum_of_triangles(sites, all),
            checksum_of_triangles(sites, all.first(3)) + checksum_of_triangles(sites, all.last(3)));
  EXPECT_EQ(checksum_of_triangles(sites, {}), 0U);
  EXPECT_EQ(checksum_of_sites({}), 0U);
}

TEST(Checksum, TextHasSixteenDigits) {
  EXPECT_EQ(checksum_text(0), "0000000000000000");
  EXPECT_EQ(checksum_text(0xabcU), "0000000000000abc");
}

TEST(Digest, EveryFieldCounts) {
  const std::set<std::uint64_t> digests{digest_of_point({1, 2}, 3, 4), digest_of_point({2, 1}, 3, 4),
                                        digest_of_point({1, 2}, 4, 4), digest_of_point({1, 2}, 3, 5),
                                        checksum_of_sites(std::vector<Point>{{1, 2}})};
  EXPECT_EQ(digests.size(), 5U);
}

} // namespace
} // namespace dovetail
