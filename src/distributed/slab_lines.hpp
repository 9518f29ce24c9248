/// Which side of a slab's lines a triangle is on. Local.
#pragma once

#include "dovetail/geometry/predicates.hpp"

#include <optional>
#include <vector>

namespace dovetail {

/// The lines around slab `slab`; the first and the last slab of all have one, or none.
class SlabLines {
public:
  SlabLines(Axis axis, const std::vector<double> &lines, int slab) {
    const auto s = static_cast<std::size_t>(slab);
    if (s > 0)
      left_ = SplitLine{lines[s - 1], axis};
    if (s < lines.size())
      right_ = SplitLine{lines[s], axis};
  }

  bool hold_circumcenter(Point a, Point b, Point c) const {
    return !(left_ && circumcenter_is_left(a, b, c, *left_)) &&
           (!right_ || circumcenter_is_left(a, b, c, *right_));
  }

  const std::optional<SplitLine> &left() const { return left_; }
  const std::optional<SplitLine> &right() const { return right_; }

private:
  std::optional<SplitLine> left_, right_;
};

} // namespace dovetail
