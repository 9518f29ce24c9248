/// A distributed mesh that grows: points are inserted where they are, and what they do not touch stays.
///
/// New points go to the slabs that hold them. The paths of the larger set are found among the old ones and
/// the new sites; every slab that got sites or whose paths changed becomes the triangulation of its own sites
/// and its paths again, by insertion into the triangles that it has, and all slabs are stitched. Why that is
/// the triangulation of all points: "Growing a mesh" in include/dovetail/README.md.
#pragma once

#include "dovetail/base/point_table.hpp"
#include "dovetail/comm/communicator.hpp"
#include "dovetail/comm/phases.hpp"
#include "dovetail/distributed/mesh.hpp"
#include "dovetail/distributed/slabs.hpp"

#include <string>
#include <vector>

namespace dovetail {

struct InsertOptions {
  /// Of points that equal each other or a site, which represents them all. first: the site that is there, or
  /// the first of the new points; lowest and highest compare the z of the site's representative too, and may
  /// replace it; error: none, it is an error. What the mesh merged when it was made stays merged.
  DuplicateRule duplicates = DuplicateRule::first;
  Progress progress;
  PhaseLog *phases = nullptr;        ///< if set, the phases place, paths, insert and stitch are added to it
  std::string mesh_name = "mesh";    ///< how errors name the mesh
  std::string points_name = "input"; ///< how errors name the points
};

/// What an insertion did, the same on all ranks.
struct InsertStatistics {
  GlobalIndex points = 0;     ///< inserted
  GlobalIndex sites = 0;      ///< that are new
  GlobalIndex duplicates = 0; ///< points less sites
  int changed_slabs = 0;      ///< that got sites or other paths; all others were left as they are
  std::vector<std::string> absent_in_points; ///< attributes that only the mesh has
  std::vector<std::string> absent_in_mesh;   ///< attributes that only the points have
};

struct GrownMesh {
  DistributedMesh mesh;
  InsertStatistics statistics;
};

/// Collective. The canonical Delaunay triangulation of the mesh's sites and the points, in the slabs and with
/// the lines of the mesh: the triangles, and the checksum, that triangulating everything would give.
///
/// mesh: with a sound layout (require_sound_layout); consumed. It need not have triangles or sites. That it
/// is the triangulation of its sites is checked as far as it is touched, not as a whole.
/// points: any distribution over the ranks, input indices from 0 on, distinct over all ranks; consumed. Their
/// indices in the mesh are those behind the largest that it has, which is where its own input ended (unless
/// records at its end had been skipped). Attributes are matched by name; what one side lacks is NaN (z: 0).
///
/// Cost of n points into N sites: sorting the points, an insertion each, O(path sites) for every slab that
/// changes, and for these slabs a linear pass that renumbers sites and corners. Slabs grow as the points
/// happen to lie: ranks get uneven shares if many points come to one place, and triangulating anew makes them
/// even. A slab that gets more than a quarter of the sites that it has is triangulated anew by itself, after
/// a look at all its old triangles. Errors, on all ranks alike: those of check_points; equal points under
/// DuplicateRule::error; slabs with more sites than LocalIndex allows (resource); a mesh of a domain, or one
/// that is found not to be what it says (input).
GrownMesh insert(const Communicator &comm, DistributedMesh &&mesh, PointTable &&points,
                 const InsertOptions &options = {});

} // namespace dovetail
