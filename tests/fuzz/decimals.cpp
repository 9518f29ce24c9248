// Decimal numbers against the C library's, both ways.
#include "target.hpp"

#include "io/points_write_text.hpp"

#include "dovetail/io/text.hpp"

#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>

using namespace dovetail;

namespace {

bool same(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) ||
         (std::isnan(a) && std::isnan(b));
}

void check_reading(const std::string &line) {
  double value = 0;
  const char *const end = parse_decimal(line.c_str(), value);
  if (end == nullptr)
    return;
  fuzz::expect(end > line.c_str() && end < line.c_str() + line.size(), "a number ends within its line");
  const std::string number(line.c_str(), end);
  char *strtod_end = nullptr;
  const double expected = std::strtod(number.c_str(), &strtod_end);
  fuzz::expect(*strtod_end == '\0', "what was read is a number in C");
  fuzz::expect(same(value, expected), "rounded as in C");
}

void check_writing(const double *numbers, std::size_t count) {
  PointTable table;
  for (std::size_t i = 0; i + 1 < count; i += 2)
    table.points.push_back({numbers[i], numbers[i + 1]});
  std::string text;
  append_lines(table, 0, table.points.size(), {}, text);
  const char *rest = text.c_str();
  for (const Point p : table.points)
    for (const double value : {p.x, p.y}) {
      char *end = nullptr;
      fuzz::expect(same(std::strtod(rest, &end), value), "what is written reads back as the same double");
      fuzz::expect(end - rest <= 24, "short");
      rest = end + 1;
    }
  fuzz::expect(rest == text.c_str() + text.size(), "nothing else");
}

} // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
  std::string text(reinterpret_cast<const char *>(data), size);
  text += '\n';
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin) + 1;
    check_reading(text.substr(begin, end - begin));
    begin = end;
  }
  std::vector<double> numbers(size / sizeof(double));
  if (!numbers.empty())
    std::memcpy(numbers.data(), data, numbers.size() * sizeof(double));
  check_writing(numbers.data(), numbers.size());
  return 0;
}

std::vector<std::string> fuzz::seeds() {
  return {
      "0.1",
      "-1.7976931348623157e308",
      "4.9e-324\n2.4703282292062327e-324\n2.4703282292062328e-324",
      "9007199254740993\n9007199254740992.99999999999999999999",
      "123456789012345678901234567890e-20",
      "1e22\n1e23\n0.000000000000000000000001",
      "+.5e+1\n5.\n-0\n00e1",
      "nan\n-inf\nInfinity",
      std::string("179769313486231570814527423731704356798070567525844996598917476803157260780028538760") +
          "5895586327668781e209",
      std::string("\0\0\0\0\0\0\xf0\x3f\x9a\x99\x99\x99\x99\x99\xb9\x3f", 16)};
}
