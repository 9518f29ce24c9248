// Numbers and lines of text, in memory. The oracle for rounding is strtod, which glibc makes correct by other
// means; the end-to-end tests have Python's.
#include "dovetail/io/text.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <random>

using namespace dovetail;

namespace {

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }

void expect_like_strtod(const std::string &text) {
  const std::string line = text + "\n";
  double value = -7;
  const char *const end = parse_decimal(line.c_str(), value);
  ASSERT_EQ(end, line.c_str() + text.size()) << text;
  EXPECT_EQ(bits(value), bits(std::strtod(text.c_str(), nullptr))) << text;
}

template <class... Values> std::string printed(const char *format, Values... values) {
  std::vector<char> buffer(2000);
  const int size = std::snprintf(buffer.data(), buffer.size(), format, values...);
  return {buffer.data(), static_cast<std::size_t>(size)};
}

TEST(TextNumbers, AnyDoubleInAnyLength) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 20'000; ++i) {
    const auto value = std::bit_cast<double>(random());
    if (!std::isfinite(value))
      continue;
    for (const char *format : {"%.17g", "%.16g", "%.15g", "%.5g", "%.45g", "%e"})
      expect_like_strtod(printed(format, value));
    // Of the size of coordinates.
    const double coordinate = std::ldexp(static_cast<double>(random() >> 11), -30 - i % 20);
    for (const char *format : {"%.17g", "%.2f", "%.6f", "%.20f", "%.60f"})
      expect_like_strtod(printed(format, coordinate));
  }
}

TEST(TextNumbers, AnyDigits) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 50'000; ++i) {
    std::string text(i % 3 == 0 ? 0 : 1, i % 3 == 1 ? '-' : '+');
    const auto digits = 1 + random() % (i % 10 == 0 ? 100 : 24);
    const auto point = random() % (digits + 1);
    for (std::uint64_t d = 0; d < digits; ++d) {
      if (d == point)
        text += '.';
      text += static_cast<char>('0' + random() % 10 * (random() % 4 != 0));
    }
    if (random() % 2 == 0)
      text += 'e' + std::to_string(static_cast<int>(random() % 80) - 40);
    expect_like_strtod(text);
  }
}

// Exactly between two doubles, and a little off, from all of 64 bits.
TEST(TextNumbers, Halfway) {
  if (std::numeric_limits<long double>::digits < 64)
    GTEST_SKIP() << "long double cannot hold what lies between two doubles";
  std::mt19937_64 random(3);
  for (int i = 0; i < 3000; ++i) {
    const auto mantissa = static_cast<long double>((random() >> 10 | std::uint64_t{1} << 53) | 1);
    const std::string text =
        printed("%.1100Lg", std::ldexp(mantissa, static_cast<int>(random() % 400) - 250));
    expect_like_strtod(text);
    if (text.find('e') == std::string::npos && text.find('.') != std::string::npos) {
      expect_like_strtod(text + "0000000000000000000000000001");
      expect_like_strtod(text.substr(0, text.size() - 1) + "4999999999999999999999999999");
    }
  }
}

TEST(TextNumbers, Borders) {
  for (const char *text : {"0",
                           "-0",
                           "+0.0",
                           ".5",
                           "5.",
                           "-.5e1",
                           "1e0",
                           "1E+2",
                           "1e-2",
                           "00012",
                           "9007199254740993",
                           "9007199254740992",
                           "9007199254740993.0000000000000000000000000000001",
                           "1e22",
                           "1e23",
                           "123e22",
                           "1.7976931348623157e308",
                           "1.7976931348623158e308",
                           "1.7976931348623159e308",
                           "1e309",
                           "-1e400",
                           "1e99999999999999999999",
                           "4.9e-324",
                           "2.5e-324",
                           "2.4e-324",
                           "1e-400",
                           "-1e-99999999999999999999",
                           "0e99999999999999999999",
                           "0.0000000000000000000000000000000000000000000000000000001e55",
                           "18446744073709551616",
                           "99999999999999999999",
                           "1000000000000000000000000000000000000000000e-42",
                           "2.2250738585072011e-308",
                           "2.2250738585072012e-308",
                           "inf",
                           "-Infinity",
                           "INF"})
    expect_like_strtod(text);
  expect_like_strtod("0." + std::string(400, '0') + "1e400");
  expect_like_strtod("1" + std::string(400, '0') + "e-400");
  expect_like_strtod("1" + std::string(400, '0'));
  expect_like_strtod("0." + std::string(400, '0') + "1");
  for (const char *text : {"nan\n", "-NaN\n", "NAN\n"}) {
    double value = 0;
    EXPECT_NE(parse_decimal(text, value), nullptr);
    EXPECT_TRUE(std::isnan(value));
  }
}

TEST(TextNumbers, WhatIsNone) {
  double value = 0;
  for (const char *text : {"\n", "-\n", "+\n", ".\n", "-.\n", "e5\n", ".e5\n", "x\n", " 1\n", "--1\n",
                           "+-1\n", "i\n", "na\n", "in\n"})
    EXPECT_EQ(parse_decimal(text, value), nullptr) << text;
  // The rest is not taken.
  const auto taken = [&](const std::string &text) {
    return std::string(text.c_str(), parse_decimal(text.c_str(), value));
  };
  EXPECT_EQ(taken("1e\n"), "1");
  EXPECT_EQ(taken("1e+\n"), "1");
  EXPECT_EQ(taken("1.5.5\n"), "1.5");
  EXPECT_EQ(taken("0x10\n"), "0");
  EXPECT_EQ(taken("infinit\n"), "inf");
  EXPECT_EQ(taken("nan(1)\n"), "nan");
  EXPECT_EQ(taken("1,5\n"), "1");
}

std::vector<double> parsed(const std::string &lines, char separator, std::vector<FieldRole> fields) {
  std::vector<double> numbers;
  parse_lines(lines, {separator, std::move(fields), false}, numbers);
  return numbers;
}

TEST(TextLines, Layouts) {
  using enum FieldRole;
  const std::vector<double> wanted{1, 2, 3, 4.5, -5, 600};
  EXPECT_EQ(parsed("1 2 3\n\n# c\n  // c\n\t4.5\t -5   6e2  \r\n", ' ', {x, y, z}), wanted);
  EXPECT_EQ(parsed("1,2,3\n4.5 , -5,\t+6e2#c\n", ',', {x, y, z}), wanted);
  EXPECT_EQ(parsed(" 1;2;3;\r\n4.5;-5;600;//c\n", ';', {x, y, z}), wanted);
  EXPECT_EQ(parsed("1 2 3 # c\n4.5 -5 600// c 7\n\r\n", ' ', {x, y, z}), wanted);
  EXPECT_TRUE(parsed("", ' ', {x, y}).empty());
  const std::vector<double> gaps =
      parsed("1,2,,4\n1,2, ,\n1,2,nan,-inf\n", ',', {x, y, attribute, attribute});
  ASSERT_EQ(gaps.size(), 12u);
  for (const std::size_t i : {2u, 6u, 7u, 10u})
    EXPECT_TRUE(std::isnan(gaps[i])) << i;
  EXPECT_EQ(gaps[3], 4);
  EXPECT_EQ(gaps[11], -std::numeric_limits<double>::infinity());
}

TEST(TextLines, Faults) {
  using enum FieldRole;
  const auto fault = [](const std::string &lines, char separator, std::vector<FieldRole> fields) {
    try {
      parsed(lines, separator, std::move(fields));
    } catch (const LineFault &found) {
      EXPECT_FALSE(found.remedy.empty());
      return std::to_string(found.offset) + " " + found.what;
    }
    return std::string("none");
  };
  EXPECT_EQ(fault("1 2\n1 b\n", ' ', {x, y}), "6 y is 'b', which is not a number");
  EXPECT_EQ(fault("1 2\n1 2x\n", ' ', {x, y}), "6 y is '2x', which is not a number");
  EXPECT_EQ(fault("1x 2\n", ' ', {x, y}), "0 x is '1x', which is not a number");
  EXPECT_EQ(fault("1\n", ' ', {x, y}), "1 the line has too few columns: the lines before have 2");
  EXPECT_EQ(fault("1 2 3\n", ' ', {x, y}), "4 the line has too many columns: the lines before have 2");
  EXPECT_EQ(fault("1,2,3\n", ',', {x, y}), "4 the line has too many columns: the lines before have 2");
  EXPECT_EQ(fault("1 2\n", ',', {x, y}), "0 x is '1 2', which is not a number");
  EXPECT_EQ(fault("1,,3\n", ',', {x, y, attribute}), "2 y is missing");
  EXPECT_EQ(fault("1,2,\n", ',', {x, y, z}), "4 z is missing");
  EXPECT_EQ(fault("1,2,,\n", ',', {x, y}), "4 the line has too many columns: the lines before have 2");
  EXPECT_EQ(fault("1 nan\n", ' ', {x, y}), "2 y is NaN (not a number)");
  EXPECT_EQ(fault("1 -inf\n", ' ', {x, y}), "2 y is infinite");
  EXPECT_EQ(fault("1 -1e999\n", ' ', {x, y}), "2 y is '-1e999', too large for a double");
  EXPECT_EQ(fault("1 2 c\n", ' ', {x, y, attribute}), "4 column 3 is 'c', which is not a number");
  EXPECT_EQ(fault("1 2\r3 4\r\n", ' ', {x, y}).substr(0, 4), "2 y ");
  EXPECT_EQ(fault("1;2,5\n", ';', {x, y}), "2 y is '2,5', which is not a number");
}

TEST(TextLines, Counting) {
  const std::string lines = "# c\n1 2\n\n \t\r\n3 4 // d\n//\n 5 6\n";
  EXPECT_EQ(count_data_lines(lines), 3);
  EXPECT_EQ(count_data_lines(""), 0);
  EXPECT_EQ(lines.substr(offset_of_data_line(lines, 1), 3), "3 4");
  EXPECT_EQ(lines.substr(offset_of_data_line(lines, 2), 3), "5 6");
}

// Whatever the borders and the buffer, every line is in exactly one range.
TEST(LineReader, EveryLineOnce) {
  for (const std::string &text :
       std::vector<std::string>{"a\nbb\n\nccc\r\ndddddddddddddddddddddddddddddddddddddddddddddddddd\ne\n",
                                "no newline at the end", "a\nb", "\n", "\n\n\n", "", "x\n\r"}) {
    const InputFile file("text", std::as_bytes(std::span(text)));
    const auto size = static_cast<std::int64_t>(text.size());
    const std::string whole = text + (text.empty() || text.back() == '\n' ? "" : "\n");
    for (const std::int64_t buffer : {1, 17, 20, 1000})
      for (std::int64_t first = 0; first <= size; ++first)
        for (std::int64_t second = first; second <= size; ++second) {
          std::string joined;
          for (const auto &[begin, end] :
               {std::pair(std::int64_t{0}, first), {first, second}, {second, size}}) {
            LineReader reader(file, 0, begin, end, buffer);
            while (reader.next()) {
              EXPECT_EQ(reader.lines(),
                        std::string_view(whole).substr(static_cast<std::size_t>(reader.offset()),
                                                       reader.lines().size()));
              EXPECT_EQ(reader.lines().back(), '\n');
              joined += reader.lines();
            }
          }
          ASSERT_EQ(joined, whole) << first << ' ' << second << ' ' << buffer;
        }
  }
}

} // namespace
