// Numbers as the command prints and reads them.
#include "cli/text.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

namespace dovetail::cli {
namespace {

TEST(Text, Separators) {
  EXPECT_EQ(with_separators(0), "0");
  EXPECT_EQ(with_separators(999), "999");
  EXPECT_EQ(with_separators(1000), "1,000");
  EXPECT_EQ(with_separators(-1), "-1");
  EXPECT_EQ(with_separators(-999), "-999");
  EXPECT_EQ(with_separators(-1234567), "-1,234,567");
  EXPECT_EQ(with_separators(std::numeric_limits<std::int64_t>::max()), "9,223,372,036,854,775,807");
  EXPECT_EQ(with_separators(std::numeric_limits<std::int64_t>::min()), "-9,223,372,036,854,775,808");
}

TEST(Text, Durations) {
  EXPECT_EQ(duration_text(0.00049), "0.000 s");
  EXPECT_EQ(duration_text(0.1234), "0.123 s");
  EXPECT_EQ(duration_text(9.9996), "10.0 s");
  EXPECT_EQ(duration_text(99.96), "1 min 40 s");
  EXPECT_EQ(duration_text(119.6), "2 min 00 s");
  EXPECT_EQ(duration_text(3599.4), "59 min 59 s");
  EXPECT_EQ(duration_text(3599.6), "1 h 00 min");
  EXPECT_EQ(duration_text(7384), "2 h 03 min");
  EXPECT_EQ(rough_duration_text(5.4), "5 s");
  EXPECT_EQ(rough_duration_text(99.6), "1 min 40 s");
}

TEST(Text, Seeds) {
  EXPECT_EQ(seed_from_text("0"), 0u);
  EXPECT_EQ(seed_from_text("18446744073709551615"), std::numeric_limits<std::uint64_t>::max());
  for (const char *wrong : {"", "-1", "+1", "1e3", "1.0", " 1", "1 ", "0x1", "18446744073709551616", "one"})
    EXPECT_THROW(seed_from_text(wrong), std::invalid_argument) << wrong;
}

TEST(Text, Sizes) {
  EXPECT_EQ(size_text(1), "1 byte");
  EXPECT_EQ(size_text(1023), "1,023 bytes");
  EXPECT_EQ(size_text(1536), "1.5 KiB");
  EXPECT_EQ(size_text(std::int64_t{3} << 30), "3.00 GiB");
}

TEST(Text, Counts) {
  EXPECT_EQ(count_from_text("0"), 0);
  EXPECT_EQ(count_from_text("1000000"), 1000000);
  EXPECT_EQ(count_from_text("1e7"), 10000000);
  EXPECT_EQ(count_from_text("2.5e6"), 2500000);
  EXPECT_EQ(count_from_text("1,000,000"), 1000000);
  EXPECT_EQ(count_from_text("9007199254740992"), GlobalIndex{1} << 53);
  for (const char *wrong :
       {"", "-1", "1.5", "1e", "e7", "1e400", "1e16", "nan", "inf", "0x10", " 1", "1 ", "ten"})
    EXPECT_THROW(count_from_text(wrong), std::invalid_argument) << wrong;
}

TEST(Text, Classes) {
  EXPECT_EQ(classes_from_text("2"), std::vector<int>({2}));
  EXPECT_EQ(classes_from_text("2,9,255,0"), std::vector<int>({2, 9, 255, 0}));
  for (const char *wrong : {"", ",", "2,", ",2", "256", "-1", "2,x", "2 9", "0002"})
    EXPECT_THROW(classes_from_text(wrong), std::invalid_argument) << wrong;
}

TEST(Text, Lists) {
  EXPECT_EQ(joined(std::vector<std::string>{}, ", "), "");
  EXPECT_EQ(joined(std::vector<std::string>{"a", "b"}, " or "), "a or b");
  EXPECT_EQ(counted(1, "rank", "ranks"), "1 rank");
  EXPECT_EQ(counted(1000, "rank", "ranks"), "1,000 ranks");
}

} // namespace
} // namespace dovetail::cli
