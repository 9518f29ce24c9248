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

void print_violations(const std::string &subject, const std::string &remedy, const ValidationReport &found) {
  fmt::print(stderr, "dovetail: {}: the mesh is not valid, {}; {}\n", subject,
             counted(found.violation_count, "violation", "violations"), remedy);
  for (const Violation &violation : found.first_violations)
    fmt::print(stderr, "  {}: {}\n", name_of(violation.kind), violation.text);
}

} // namespace dovetail::cli
