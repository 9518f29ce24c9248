/// Is a distributed mesh the canonical Delaunay triangulation of its sites? Decided in exact arithmetic that
/// shares no filter with the code that made the mesh.
///
/// The criterion (include/dovetail/README.md): every triangle counter-clockwise, adjacency symmetric, every
/// inner edge locally Delaunay by the canonical rule, and the boundary one cycle that goes once up and once
/// down in lexicographic order and turns left or straight everywhere. Local tests and Euler's relation alone
/// would let a boundary pass that winds twice. Beyond that: all that a mesh says about itself (slabs, paths,
/// ghosts, numbers, duplicates, checksum, digest) is compared with what its sites and triangles say.
#pragma once

#include "dovetail/base/progress.hpp"
#include "dovetail/comm/communicator.hpp"
#include "dovetail/distributed/mesh.hpp"
#include "dovetail/distributed/slab_source.hpp"

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace dovetail {

enum class ViolationKind : std::uint8_t {
  layout,      ///< array sizes and index ranges do not fit together; nothing else is checked then
  coordinate,  ///< not finite, or -0.0
  order,       ///< own sites not strictly ascending in the total order, within or across slabs
  line,        ///< a split line is not between the sites before and behind it
  orientation, ///< a triangle is not counter-clockwise, or has a corner twice
  slab,        ///< a circumcenter is not between its slab's lines
  adjacency,   ///< a neighbour does not have the same edge, reversed, with this triangle beyond
  delaunay,    ///< an inner edge is not locally Delaunay by the canonical rule
  hull,        ///< the boundary is not one convex cycle, or hull_edges does not count it
  euler,       ///< triangles != 2 sites - 2 - hull edges
  unused_site, ///< a site, or a slab's ghost, is in no triangle
  collinear,   ///< there are no triangles, but the sites are not on one line
  ghost,       ///< a ghost differs from the site it stands for
  path,        ///< a stored path is not the path that the triangles show
  duplicate,   ///< the duplicate map is out of order or names no site
  checksum,    ///< the stored checksum is not that of sites and triangles
  digest,      ///< the stored digest is not that of sites and duplicates
  input,       ///< the points given beside the mesh are not its sites and duplicates
};
inline constexpr std::size_t violation_kinds = 18;

/// Such as "adjacency": for reports.
std::string_view name_of(ViolationKind kind);

struct Violation {
  ViolationKind kind;
  std::string text; ///< where and what: slab, triangle, sites, coordinates
};

/// Global numbers of what was checked and found; the same on all ranks.
struct ValidationReport {
  bool valid = false;
  GlobalIndex sites = 0;
  GlobalIndex ghosts = 0;
  GlobalIndex triangles = 0;
  GlobalIndex inner_edges = 0;  ///< tested to be locally Delaunay, border edges included
  GlobalIndex border_edges = 0; ///< those of them that lie between two slabs
  GlobalIndex hull_edges = 0;
  GlobalIndex path_edges = 0; ///< of all paths together
  GlobalIndex duplicates = 0;
  GlobalIndex input_points = 0; ///< compared one by one with sites and duplicates; 0 without `points`
  std::uint64_t checksum = 0;   ///< recomputed

  GlobalIndex violation_count = 0;
  std::array<GlobalIndex, violation_kinds> violations_by_kind{}; ///< by ViolationKind
  std::vector<Violation> first_violations;                       ///< a few of every kind
};

/// Collective. Needs memory for what crosses between ranks: borders, ghosts, hull and paths.
/// Three exact predicates a triangle and one an edge.
/// `progress` hears of the stage "check", which is the triangles' share: nearly all of the work.
ValidationReport validate(const Communicator &comm, const DistributedMesh &mesh,
                          const Progress &progress = {});

/// Collective. The same, and every point of the original input, spread over the ranks in any way, must be
/// exactly one site or listed duplicate with the same coordinates and z, and the other way round.
ValidationReport validate(const Communicator &comm, const DistributedMesh &mesh, const PointTable &points,
                          const Progress &progress = {});

/// Collective. The same of a mesh whose slabs come one at a time: each is asked for once, so that memory is
/// needed for one slab, and with `points` for their share as well; then its vertices are asked for once more
/// for every round of some million points a rank.
ValidationReport validate(const Communicator &comm, SlabSource &source, const Progress &progress = {});
ValidationReport validate(const Communicator &comm, SlabSource &source, const PointTable &points,
                          const Progress &progress = {});

/// Collective. Throws an Error (input) about `subject` unless array sizes and index ranges fit together and
/// all coordinates are finite, which is what whoever walks over a mesh must rely on. Cheap.
void require_sound_layout(const Communicator &comm, const DistributedMesh &mesh, const std::string &subject);

} // namespace dovetail
