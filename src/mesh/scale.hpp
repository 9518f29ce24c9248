/// Coordinates of a size whose fourth powers neither overflow nor underflow. Private to mesh.
#pragma once

#include "dovetail/base/types.hpp"

#include <optional>
#include <span>

namespace dovetail {

/// The power of two by which all coordinates can be divided without rounding, so that the greatest is about
/// one; 0 if that is not needed. Nothing if it is not possible: coordinates are of too different sizes.
std::optional<int> scale_exponent(std::span<const Point> points);

/// Times 2^exponent.
void scale(std::span<Point> points, int exponent);

} // namespace dovetail
