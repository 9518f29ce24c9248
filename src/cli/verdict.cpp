#include "verdict.hpp"

#include "text.hpp"

#include <fmt/format.h>

namespace dovetail::cli {

std::string axis_name(Axis axis) { return axis == Axis::x ? "x" : "y"; }

std::string no_triangles_reason(GlobalIndex sites) {
  if (sites < 3)
    return fmt::format("no triangles, since there {}", sites == 0   ? "are no sites"
                                                       : sites == 1 ? "is only 1 site"
                                                                    : "are only 2 sites");
  return fmt::format("no triangles, since all {} sites lie on one line", with_separators(sites));
}

} // namespace dovetail::cli
