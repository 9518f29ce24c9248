/// The cavity of a new site: the triangles whose circles hold it, and the star that takes their place. In two
/// steps: `find_cavity` reads only, `commit` changes. Local.
///
/// (Bowyer, Computing Dirichlet tessellations, 1981; Watson, Computing the n-dimensional Delaunay
/// tessellation, 1981.) Why the search needs no marks, and no repair: let the site p see the edge a b of a
/// triangle a b w beyond it whose circle holds p. Then p and w are in one disk on two sides of its chord a b,
/// so the segment p w crosses the chord, and w is seen from p between a and b. So a cavity found edge by edge
/// is always star-shaped from p, its triangles form a tree, and a search in the order of sides gives the
/// boundary counter-clockwise. Nothing of this asks for a Delaunay mesh; in one, the star is Delaunay again,
/// and in a constrained one, where no locked edge is crossed, constrained Delaunay. Canonical, as in_circle
/// is.
///
/// A site outside of a convex hull is joined with the hull edges that it sees strictly: imagine triangles to
/// a point at infinity beyond the hull, of which those are in the cavity.
#pragma once

#include "dovetail/geometry/seen.hpp"
#include "dovetail/mesh/half_edge.hpp"
#include "dovetail/mesh/locate.hpp"

#include <cassert>
#include <span>
#include <vector>

namespace dovetail {

/// An edge of the boundary, the new site on its left.
struct CavityEdge {
  LocalIndex from;
  LocalIndex to;
  HalfEdge beyond; ///< the side of the triangle on its right, outside of the cavity; `none` on the hull
  HalfEdge side;   ///< the side of a triangle of the cavity that it is; `none` for a hull edge that a site
                   ///< outside sees, which is `beyond` only
};

/// What a new site replaces, and the memory to find it with: keep one and pass it again, and nothing is
/// allocated once it is large enough.
struct Cavity {
  std::vector<LocalIndex> triangles; ///< empty if the site is outside and in no triangle's circle
  std::vector<CavityEdge> edges;     ///< counter-clockwise around the site
  HalfEdge split = none;             ///< of a site inside an edge: a side of the cavity that this edge is,
  LocalIndex split_from = none;      ///< and its ends
  LocalIndex split_to = none;
  bool closed = true; ///< false: the site is on the border or outside, and the boundary is a chain from
                      ///< edges.front().from to edges.back().to
  bool has_locked_side = false; ///< a triangle of the cavity has one, or one is seen from outside; an edge
                                ///< that is split counts

  /// A side still to be looked across, its ends as seen from the site.
  struct Front {
    HalfEdge side;
    LocalIndex from;
    LocalIndex to;
    Seen from_seen;
    Seen to_seen;
    double cross; ///< of these two
  };
  std::vector<Front> fronts;   ///< empty between calls
  std::vector<HalfEdge> sides; ///< what flips work with (flip.hpp); empty between calls
};

/// Is a site inside the circle of a triangle? By the canonical rule; it must not be a corner.
inline bool is_in_circle(std::span<const Point> sites, const Triangulation &mesh, LocalIndex triangle,
                         Point site) {
  const LocalIndex *corner = &mesh.corners[position(half_edge(triangle, 0))];
  return in_circle(sites[position(corner[0])], sites[position(corner[1])], sites[position(corner[2])],
                   site) == Sign::positive;
}

namespace cavity_search {

template <class Locked> struct Search {
  std::span<const Point> sites;
  const Triangulation &mesh;
  Point site;
  const Locked &locked;
  Cavity &cavity;

  using Front = Cavity::Front;

  Seen see(LocalIndex vertex) const { return dovetail::see(sites[position(vertex)], site); }

  bool is_locked(HalfEdge h) const {
    const bool yes = locked(triangle_of(h), side_of(h));
    cavity.has_locked_side |= yes;
    return yes;
  }

  static Front front(HalfEdge side, LocalIndex from, LocalIndex to, const Seen &from_seen,
                     const Seen &to_seen) {
    return {side, from, to, from_seen, to_seen, dovetail::cross(from_seen, to_seen)};
  }

  /// What the filter leaves undecided.
  [[gnu::noinline, gnu::cold]] Sign undecided(LocalIndex triangle) const {
    return is_in_circle(sites, mesh, triangle, site) ? Sign::positive : Sign::negative;
  }

  /// Looks across a side, and on from those of a triangle that is taken. The one that comes later waits in
  /// `fronts`, and all that waits is looked across.
  void cross(Front front) const {
    for (;;) {
      const LocalIndex beyond = mesh.neighbours[position(front.side)];
      if (is_locked(front.side) || beyond == none) [[unlikely]] {
        cavity.edges.push_back({front.from, front.to, twin(mesh, front.side), front.side});
      } else {
        const HalfEdge h = half_edge_towards(mesh, beyond, triangle_of(front.side));
        const LocalIndex tip = apex(mesh, h);
        const Seen tip_seen = see(tip);
        const double to_tip = dovetail::cross(front.from_seen, tip_seen);
        const double from_tip = dovetail::cross(tip_seen, front.to_seen);
        Sign sign =
            filter::in_circle(front.from_seen, front.to_seen, tip_seen, front.cross, to_tip, from_tip);
        if (sign == Sign::zero) [[unlikely]]
          sign = undecided(beyond);
        if (sign == Sign::positive) {
          cavity.triangles.push_back(beyond);
          cavity.fronts.push_back({before(h), tip, front.to, tip_seen, front.to_seen, from_tip});
          front.side = after(h);
          front.to = tip;
          front.to_seen = tip_seen;
          front.cross = to_tip;
          continue;
        }
        cavity.edges.push_back({front.from, front.to, h, front.side});
      }
      if (cavity.fronts.empty())
        return;
      front = cavity.fronts.back();
      cavity.fronts.pop_back();
    }
  }

  /// Takes the triangle of h, and what is reached across its other two sides.
  void take(HalfEdge h) const {
    cavity.triangles.push_back(triangle_of(h));
    const LocalIndex from = target(mesh, h), tip = apex(mesh, h), to = origin(mesh, h);
    const Seen tip_seen = see(tip);
    cavity.fronts.push_back(front(before(h), tip, to, tip_seen, see(to)));
    cross(front(after(h), from, tip, see(from), tip_seen));
  }

  void from_inside(LocalIndex triangle) const {
    cavity.triangles.push_back(triangle);
    const HalfEdge h = half_edge(triangle, 0);
    const LocalIndex *corner = &mesh.corners[position(h)];
    const LocalIndex a = corner[0], b = corner[1], c = corner[2];
    const Seen a_seen = see(a), b_seen = see(b), c_seen = see(c);
    cavity.fronts.push_back(front(h + 2, a, b, a_seen, b_seen));
    cavity.fronts.push_back(front(h + 1, c, a, c_seen, a_seen));
    cross(front(h, b, c, b_seen, c_seen));
  }

  void from_edge(HalfEdge edge) const {
    cavity.split = edge;
    cavity.split_from = origin(mesh, edge);
    cavity.split_to = target(mesh, edge);
    is_locked(edge);
    take(edge); // from where the edge ends to where it begins
    const HalfEdge beyond = twin(mesh, edge);
    cavity.closed = beyond != none;
    if (beyond != none)
      take(beyond);
  }

  bool sees(HalfEdge hull_edge) const {
    return orientation(sites[position(origin(mesh, hull_edge))], sites[position(target(mesh, hull_edge))],
                       site) == Sign::negative;
  }

  /// `seen`: a hull edge. Counter-clockwise around the site is clockwise along the hull.
  void from_outside(HalfEdge seen) const {
    cavity.closed = false;
    for (HalfEdge next = hull_after(mesh, seen); sees(next); next = hull_after(mesh, seen))
      seen = next;
    do {
      if (!is_locked(seen) && is_in_circle(sites, mesh, triangle_of(seen), site))
        take(seen);
      else
        cavity.edges.push_back({target(mesh, seen), origin(mesh, seen), seen, none});
      seen = hull_before(mesh, seen);
    } while (sees(seen));
  }
};

} // namespace cavity_search

/// Finds the cavity of a site, which may but need not be in `sites` yet, at its place by `locate` with the
/// same `locked`: `inside`, `edge` (of a locked edge too: it is split), or `outside`, which needs a convex
/// border. What `found` held before is forgotten.
///
/// O(triangles of the cavity): one in_circle for each of them and for each edge of its boundary; six on
/// average for random insertions. From outside also the triangles at the ends of the hull edges that are
/// seen.
template <class Locked = NothingLocked>
void find_cavity(std::span<const Point> sites, const Triangulation &mesh, Point site, const Place &place,
                 Cavity &found, const Locked &locked = {}) {
  found.triangles.clear();
  found.edges.clear();
  found.fronts.clear(); // not empty if `locked` has thrown
  found.split = none;
  found.closed = true;
  found.has_locked_side = false;
  const cavity_search::Search<Locked> search{sites, mesh, site, locked, found};
  switch (place.kind) {
  case PlaceKind::inside:
    search.from_inside(place.triangle);
    break;
  case PlaceKind::edge:
    search.from_edge(half_edge(place.triangle, place.side));
    break;
  case PlaceKind::outside:
    search.from_outside(half_edge(place.triangle, place.side));
    break;
  case PlaceKind::vertex:
  case PlaceKind::blocked:
    assert(false); // a site that is there already, or cannot be reached, has no cavity
  }
}

/// The triangle that `commit` makes, or has made, on edge e of the boundary: the slots of the cavity's
/// triangles first, in their order, then new ones, which begin at `first_new`: the count before.
inline LocalIndex star_triangle(const Cavity &cavity, LocalIndex first_new, std::size_t e) {
  return e < cavity.triangles.size() ? cavity.triangles[e]
                                     : first_new + static_cast<LocalIndex>(e - cavity.triangles.size());
}

/// Replaces the cavity by the star of `vertex`; O(edges of the boundary). Triangle e of the star has the
/// corners `vertex`, edges[e].from, edges[e].to: so its side 0 is edge e, its side 1 ends at the vertex and
/// its side 2 begins there. All triangles that were not in the cavity keep their numbers; the star's are
/// those of the cavity and, at the end, as many as are needed (two more, or on the border and outside at
/// least one). Returns the count of triangles before: `first_new`. More half-edges than LocalIndex can number
/// are an Error (resource), and nothing is changed then.
LocalIndex commit(Triangulation &mesh, const Cavity &cavity, LocalIndex vertex);

/// Takes along values that a caller keeps by side (at [3t + i], the same from both sides of an edge), after a
/// commit: edges of the boundary keep theirs, both halves of an edge that was split get that of the whole,
/// and the other sides of the star get `fresh`. `kept` is memory.
template <class Value>
void carry_sides(const Cavity &cavity, LocalIndex first_new, const Value &fresh, std::vector<Value> &of_side,
                 std::vector<Value> &kept) {
  kept.clear();
  for (const CavityEdge &edge : cavity.edges)
    kept.push_back(of_side[position(edge.side != none ? edge.side : edge.beyond)]);
  const Value whole = cavity.split != none ? of_side[position(cavity.split)] : fresh;
  const auto spoke = [&](LocalIndex end) {
    return end == cavity.split_from || end == cavity.split_to ? whole : fresh;
  };
  const std::size_t added = cavity.edges.size() - cavity.triangles.size();
  of_side.resize(3 * (position(first_new) + added), fresh);
  for (std::size_t e = 0; e < cavity.edges.size(); ++e) {
    const std::size_t side = position(half_edge(star_triangle(cavity, first_new, e), 0));
    of_side[side] = kept[e];
    of_side[side + 1] = spoke(cavity.edges[e].to);
    of_side[side + 2] = spoke(cavity.edges[e].from);
  }
}

} // namespace dovetail
