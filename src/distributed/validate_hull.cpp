// The boundary, and the paths. Both are looked at edge by edge, each where it is known.
#include "validation.hpp"

#include "dovetail/geometry/predicates.hpp"

#include <fmt/format.h>

namespace dovetail::validation {
namespace {

struct Extremes {
  GlobalIndex low = 0, high = 0;
};

/// The hull edges at one site: exactly one must arrive and one leave, turning left or going straight on.
void check_hull_vertex(const Point p, std::span<const HullNotice> notices, Extremes &extremes,
                       Findings &findings) {
  const GlobalIndex site = notices.front().site;
  const auto leaving = std::ranges::count(notices, 1, &HullNotice::leaves);
  if (leaving != 1 || notices.size() != 2) {
    findings.add(ViolationKind::hull, [&] {
      return fmt::format("site {} {}: {} boundary edges arrive and {} leave", site, text_of(p),
                         static_cast<std::ptrdiff_t>(notices.size()) - leaving, leaving);
    });
    return;
  }
  const HullNotice &arriving = notices[notices[0].leaves == 1 ? 1 : 0];
  const HullNotice &departing = notices[notices[0].leaves == 1 ? 0 : 1];
  const bool ascends = lexicographically_less(arriving.other_point, p);
  const bool ascends_after = lexicographically_less(p, departing.other_point);
  extremes.low += !ascends && ascends_after;
  extremes.high += ascends && !ascends_after;
  const Sign turn = exact::orientation(arriving.other_point, p, departing.other_point);
  if (turn == Sign::negative || (turn == Sign::zero && ascends != ascends_after))
    findings.add(ViolationKind::hull, [&] {
      return fmt::format("site {} {}: the boundary turns {} between sites {} and {}", site, text_of(p),
                         turn == Sign::zero ? "back" : "right", arriving.other, departing.other);
    });
}

} // namespace

void gather_hull(const SlabMesh &slab, Gathered &gathered, Findings &findings) {
  for_each_hull_side(slab, [&](LocalIndex side) {
    const Side edge = side_of(slab, side);
    const GlobalIndex from = number_of(slab, edge.from);
    const GlobalIndex to = number_of(slab, edge.to);
    gathered.hull.push_back({from, to, point_of(slab, edge.from), point_of(slab, edge.to), 1});
    gathered.hull.push_back({to, from, point_of(slab, edge.to), point_of(slab, edge.from), 0});
    ++findings.counts.hull_edges;
  });
}

// Why looking at one vertex at a time is enough. If one edge arrives and one leaves at every boundary vertex,
// the boundary is a set of closed cycles. Each of them has a lexicographically lowest vertex, where it goes
// from descending to ascending; if there is one such vertex in all, there is one cycle, and if there is one
// highest as well, the cycle goes once up and once down. On its way up all directions lie in a half-open half
// circle, so with left turns only it turns by less than 180 degrees, likewise down; at both ends it turns by
// less than 180 (a turn of 180 is refused as turning back). That is less than 720 in all, more than 0 and a
// multiple of 360: the boundary is a convex polygon, passed once. A boundary that winds twice, such as that
// of a pentagram, has two lowest vertices.
void check_hull(const Communicator &comm, const DistributedMesh &common, const Ownership &owners,
                const Gathered &gathered, Findings &findings) {
  auto notices = deliver(comm, gathered.hull,
                         [&](const HullNotice &notice) { return owners.rank_of_site(notice.site); });
  std::ranges::sort(notices, {}, &HullNotice::site);
  Extremes extremes;
  for (std::size_t begin = 0, end = 0; begin < notices.size(); begin = end) {
    while (end < notices.size() && notices[end].site == notices[begin].site)
      ++end;
    check_hull_vertex(notices[begin].site_point, std::span(notices).subspan(begin, end - begin), extremes,
                      findings);
  }
  const auto sums =
      all_reduce_sum(comm, std::vector<GlobalIndex>{extremes.low, extremes.high, findings.counts.hull_edges});
  if (!comm.is_root())
    return;
  if (sums[0] != 1 || sums[1] != 1)
    findings.add(ViolationKind::hull, [&] {
      return fmt::format("the boundary goes up {} times and down {} times, where once must be", sums[0],
                         sums[1]);
    });
  if (sums[2] != common.hull_edges)
    findings.add(ViolationKind::hull, [&] {
      return fmt::format("the mesh says {} hull edges, and has {}", common.hull_edges, sums[2]);
    });
  if (const GlobalIndex expected = 2 * common.site_count() - 2 - sums[2]; common.triangle_count() != expected)
    findings.add(ViolationKind::euler, [&] {
      return fmt::format("{} triangles where {} sites and {} hull edges call for {}", common.triangle_count(),
                         common.site_count(), sums[2], expected);
    });
}

namespace {

/// Adds the edge, of a triangle in slab s with what is beyond in slab `beyond` (-1 or the number of slabs:
/// the outside), to the paths of all lines between the two, if the triangle is on the lower side of the
/// lines' coordinate and so has the telling.
void add_path_edge(const DistributedMesh &common, const SlabMesh &slab, int s, LocalIndex side, bool is_hull,
                   int beyond, std::vector<PathNotice> &notices) {
  const Side edge = side_of(slab, side);
  const double from = along(point_of(slab, edge.from), common.axis);
  const double to = along(point_of(slab, edge.to), common.axis);
  if (from == to)
    return; // parallel to the Voronoi edge's line: no line crosses it
  // A counter-clockwise triangle lies left of its edge, which is the side of smaller x going up, and that of
  // larger y going right.
  const bool is_low_side = (from < to) == (common.axis == Axis::x);
  if (!is_hull && !is_low_side)
    return;
  const int first = is_low_side ? s + 1 : 1;
  const int last = !is_hull ? beyond : is_low_side ? common.slab_count() - 1 : s;
  GlobalIndex low = number_of(slab, edge.from);
  GlobalIndex high = number_of(slab, edge.to);
  if (to < from)
    std::swap(low, high);
  for (int line = first; line <= last; ++line)
    notices.push_back({line, low, high});
}

} // namespace

void gather_paths(const DistributedMesh &common, const SlabMesh &slab, int s, const Ownership &owners,
                  Gathered &gathered) {
  for (const BorderSide &border : slab.border_sides)
    add_path_edge(common, slab, s, border.side, false, owners.slab_of_triangle(border.neighbour),
                  gathered.path_edges);
  for_each_hull_side(
      slab, [&](LocalIndex side) { add_path_edge(common, slab, s, side, true, none, gathered.path_edges); });
}

namespace {

void check_path(const std::vector<GlobalIndex> &path, int s, std::span<const PathNotice> expected,
                Findings &findings) {
  std::vector<PathNotice> stored;
  for (std::size_t i = 1; i < path.size(); ++i)
    stored.push_back({s, path[i - 1], path[i]});
  findings.counts.path_edges += static_cast<GlobalIndex>(stored.size());
  std::ranges::sort(stored);
  const auto [has, needs] = std::ranges::mismatch(stored, expected);
  if (has == stored.end() && needs == expected.end())
    return;
  findings.add(ViolationKind::path, [&] {
    const bool extra = needs == expected.end() || (has != stored.end() && *has < *needs);
    const PathNotice &edge = extra ? *has : *needs;
    return fmt::format(
        "slab {}: its left path {} the edge from site {} to site {}, and the triangles show {}", s,
        extra ? "has" : "lacks", edge.from, edge.to, extra ? "none there" : "it");
  });
}

} // namespace

// An edge is on the path of a line exactly if its Voronoi edge crosses the line (F1), that is, if the
// circumcenter of the triangle on its lower side is left of the line (F2: the triangle is in a slab left of
// it) and that on its upper side is right of it. Where there is nothing beyond, the Voronoi edge runs to
// infinity, away from the line if the edge is parallel to the coordinate that is cut. So the triangles on
// borders and hull know all edges of all paths, and a path is right if it has these and no others.
void check_paths(const Communicator &comm, const DistributedMesh &common, const Ownership &owners,
                 const Gathered &gathered, Findings &findings) {
  auto notices = deliver(comm, gathered.path_edges, [&](const PathNotice &notice) {
    return owners.rank_of_slab(static_cast<int>(notice.slab));
  });
  std::ranges::sort(notices);
  collectively(comm, checking_text, [&] {
    int s = common.first_slab;
    for (const std::vector<GlobalIndex> &path : gathered.left_paths) {
      const auto range = std::ranges::equal_range(notices, s, {}, &PathNotice::slab);
      if (s > 0)
        check_path(path, s, std::span<const PathNotice>(range.begin(), range.end()), findings);
      ++s;
    }
  });
}

} // namespace dovetail::validation
