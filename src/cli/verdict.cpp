#include "verdict.hpp"

#include "text.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace dovetail::cli {

std::string axis_name(Axis axis) { return axis == Axis::x ? "x" : "y"; }

std::string no_triangles_reason(GlobalIndex sites) {
  if (sites < 3)
    return fmt::format("no triangles, since there {}", sites == 0   ? "are no sites"
                                                       : sites == 1 ? "is only 1 site"
                                                                    : "are only 2 sites");
  return fmt::format("no triangles, since all {} sites lie on one line", with_separators(sites));
}

bool only_the_points_differ(const ValidationReport &found) {
  return !found.valid &&
         found.violations_by_kind[static_cast<std::size_t>(ViolationKind::input)] == found.violation_count;
}

void print_violations(const std::string &subject, const std::string &fault, const std::string &remedy,
                      const ValidationReport &found) {
  fmt::print(stderr, "dovetail: {}: {}, {}; {}\n", subject, fault,
             counted(found.violation_count, "violation", "violations"), remedy);
  for (const Violation &violation : found.first_violations)
    fmt::print(stderr, "  {}: {}\n", name_of(violation.kind), violation.text);
}

} // namespace dovetail::cli
