/// Where two segments cross: a rounded construction, the best that doubles allow. Local.
#pragma once

#include "dovetail/base/types.hpp"

namespace dovetail {

/// The point common to the lines through a, b and through c, d, which must not be parallel: the exact
/// rational point, of which each coordinate is then rounded to the nearest double, ties to even (below the
/// normal doubles, to one of the two nearest). So where the segments cross, the result lies in the bounding
/// boxes of both, and does not depend on which segment, or which end, comes first.
Point line_intersection(Point a, Point b, Point c, Point d);

} // namespace dovetail
