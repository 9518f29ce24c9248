/// A slab's triangles completed to those of all its sites. Private to distributed. Local.
#pragma once

#include "growing_slab.hpp"

namespace dovetail::insertion {

/// Adds to the slab's triangles, which are those between its lines, the ones beyond them: the triangles of
/// the slab's own sites and of its old paths are then all there, joined as neighbours. Those beyond a line
/// have all corners on its path, and so are those of the path's sites alone that are beyond the line. They
/// come behind the slab's own triangles, which keep their numbers. O(k log k) for k sites on both paths. No
/// triangles if all these sites are collinear.
void complete_slab(GrowingSlab &slab, const SlabPaths &paths, const SlabLines &lines);

} // namespace dovetail::insertion
