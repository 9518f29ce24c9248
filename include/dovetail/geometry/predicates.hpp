/// The predicates that are the only source of topology. Local; thread-safe; no state.
///
/// Each is right for every finite double: a floating-point filter decides what it can, exact integer
/// arithmetic on the aligned mantissas decides the rest, so neither overflow nor underflow can spoil a sign.
/// The filter is inline and costs a few nanoseconds; the exact stage is out of line.
#pragma once

#include "dovetail/base/sign.hpp"
#include "dovetail/base/types.hpp"

namespace dovetail {

/// The line x = m+ (Axis::x) or y = m+ (Axis::y): `position` plus an infinitesimal.
struct SplitLine {
  double position;
  Axis axis;
};

/// Positive if a, b, c turn counter-clockwise, zero if they are collinear.
Sign orientation(Point a, Point b, Point c);

/// Positive if d lies inside the circle of the counter-clockwise a, b, c. Never zero for four distinct
/// points: ties are settled by the symbolic perturbation of the lifted height in which the lexicographically
/// larger site dominates (include/dovetail/README.md). a, b, c must not be collinear.
Sign in_circle(Point a, Point b, Point c, Point d);

/// Turn of a, b, c after projection to (along, (across - m)^2 + along^2): the lower hull of the projected
/// sites is the split path. Positive is a left turn (the hull is convex at b). Zero only for collinear a, b,
/// c.
Sign hull_turn(Point a, Point b, Point c, SplitLine line);

/// The same polynomial for pruning, before the line is moved to m+: sign of D(a, b, c, m).
Sign hull_turn_unperturbed(Point a, Point b, Point c, SplitLine line);

/// True if the circumcenter of the (not collinear) a, b, c, in either orientation, has across <= m.
bool circumcenter_is_left(Point a, Point b, Point c, SplitLine line);

/// The same four without the filters: what certification uses, so that a fault in a filter cannot hide
/// itself.
namespace exact {
Sign orientation(Point a, Point b, Point c);
Sign in_circle(Point a, Point b, Point c, Point d);
Sign hull_turn(Point a, Point b, Point c, SplitLine line);
Sign hull_turn_unperturbed(Point a, Point b, Point c, SplitLine line);
bool circumcenter_is_left(Point a, Point b, Point c, SplitLine line);
} // namespace exact

} // namespace dovetail
