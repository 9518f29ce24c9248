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
#include <utility>
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

  /// Two sides of a triangle of the cavity that follow each other, and what lies beyond each.
  struct Front {
    HalfEdge side[2];
    LocalIndex vertex[3]; ///< where the first begins, where both meet, where the second ends
    LocalIndex beyond[2]; ///< triangles; on the hull the side's own
    LocalIndex tip[2];    ///< their corners across
    bool taken[2];        ///< belongs to the cavity
    Seen from;            ///< the ends of the two sides, and the tips
    Seen to;
    Seen tips;
    Pair from_cross_tip;
    Pair tip_cross_to;
    std::size_t edges; ///< so many of `later` come after these sides
    Front() {}         ///< sets nothing: all is set when it is looked across
  };
  std::vector<Front> fronts;     ///< empty between calls
  std::vector<CavityEdge> later; ///< edges that come after a front; the last one first; empty between calls
  std::vector<HalfEdge> sides;   ///< what flips work with (flip.hpp); empty between calls
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

  Pair see(LocalIndex vertex) const { return dovetail::see(sites[position(vertex)], site); }

  bool is_locked(HalfEdge h) const {
    const bool yes = locked(triangle_of(h), side_of(h));
    cavity.has_locked_side |= yes;
    return yes;
  }

  /// What the filter leaves undecided.
  [[gnu::noinline, gnu::cold]] bool undecided(LocalIndex triangle) const {
    return is_in_circle(sites, mesh, triangle, site);
  }

  /// Looks across both sides of a front, of which all is known but what lies beyond: before it is known
  /// whether the first will be taken, so that the processor need not wait for the one to begin the other.
  void look(Front &front, Pair from_cross_to) const {
    bool open[2];
    for (std::size_t i = 0; i < 2; ++i) {
      const LocalIndex beyond = mesh.neighbours[position(front.side[i])];
      open[i] = !is_locked(front.side[i]) && beyond != none;
      front.beyond[i] = beyond != none ? beyond : triangle_of(front.side[i]);
      front.tip[i] = third_corner(mesh, front.beyond[i], front.vertex[i], front.vertex[i + 1]);
    }
    front.tips = both(see(front.tip[0]), see(front.tip[1]));
    front.from_cross_tip = dovetail::cross(front.from, front.tips);
    front.tip_cross_to = dovetail::cross(front.tips, front.to);
    const filter::Bounded circle = filter::in_circle(front.from, front.to, front.tips, from_cross_to,
                                                     front.from_cross_tip, front.tip_cross_to);
    const auto inside = circle.value > circle.bound, decided = inside | (-circle.value > circle.bound);
    for (std::size_t i = 0; i < 2; ++i) {
      front.taken[i] = inside[i] != 0;
      if (decided[i] == 0 && open[i]) [[unlikely]]
        front.taken[i] = undecided(front.beyond[i]);
      front.taken[i] &= open[i];
    }
  }

  /// Takes the triangle beyond side I: its other two sides take the place of this one.
  template <int I> void take(const Front &front, Front &next) const {
    const LocalIndex triangle = front.beyond[I], from = front.vertex[I], to = front.vertex[I + 1];
    cavity.triangles.push_back(triangle);
    next.side[0] = side_across(mesh, triangle, to);
    next.side[1] = side_across(mesh, triangle, from);
    next.vertex[0] = from;
    next.vertex[1] = front.tip[I];
    next.vertex[2] = to;
    next.from = both<I>(front.from, front.tips);
    next.to = both<I>(front.tips, front.to);
    next.edges = cavity.later.size();
    look(next, both<I>(front.from_cross_tip, front.tip_cross_to));
  }

  /// Side I, if nothing beyond is taken.
  template <int I> CavityEdge edge(const Front &front) const {
    const bool hull = mesh.neighbours[position(front.side[I])] == none;
    return {front.vertex[I], front.vertex[I + 1],
            hull ? none : side_across(mesh, front.beyond[I], front.tip[I]), front.side[I]};
  }

  /// What is reached across the two sides of a front, and across all that waits. Both are overwritten: they
  /// take turns, so that no front is copied.
  void search(Front &one, Front &other) const {
    Front *front = &one, *next = &other;
    for (;;) {
      if (front->taken[0]) {
        take<0>(*front, *next);
        if (front->taken[1])
          take<1>(*front, cavity.fronts.emplace_back());
        else
          cavity.later.push_back(edge<1>(*front));
        std::swap(front, next);
        continue;
      }
      cavity.edges.push_back(edge<0>(*front));
      if (front->taken[1]) {
        take<1>(*front, *next);
        std::swap(front, next);
        continue;
      }
      cavity.edges.push_back(edge<1>(*front));
      const std::size_t edges = cavity.fronts.empty() ? 0 : cavity.fronts.back().edges;
      for (; cavity.later.size() > edges; cavity.later.pop_back())
        cavity.edges.push_back(cavity.later.back());
      if (cavity.fronts.empty())
        return;
      *front = cavity.fronts.back();
      cavity.fronts.pop_back();
    }
  }

  /// The sides from a to b and from b to c of a triangle of the cavity.
  void begin(Front &front, HalfEdge ab, HalfEdge bc, LocalIndex a, LocalIndex b, LocalIndex c) const {
    front.side[0] = ab;
    front.side[1] = bc;
    front.vertex[0] = a;
    front.vertex[1] = b;
    front.vertex[2] = c;
    const Pair b_seen = see(b);
    front.from = both(see(a), b_seen);
    front.to = both(b_seen, see(c));
    front.edges = 0;
    look(front, dovetail::cross(front.from, front.to));
  }

  /// Takes the triangle of h, and what is reached across its other two sides.
  void take(HalfEdge h) const {
    cavity.triangles.push_back(triangle_of(h));
    Front first, memory;
    begin(first, after(h), before(h), target(mesh, h), apex(mesh, h), origin(mesh, h));
    search(first, memory);
  }

  void from_inside(LocalIndex triangle) const {
    cavity.triangles.push_back(triangle);
    const HalfEdge h = half_edge(triangle, 0);
    const LocalIndex *corner = &mesh.corners[position(h)];
    const LocalIndex a = corner[0], b = corner[1], c = corner[2];
    Front first, last;
    begin(first, h, h + 1, b, c, a);
    begin(last, h + 2, h, a, b, c); // of which only the first side is wanted
    if (last.taken[0])
      take<0>(last, cavity.fronts.emplace_back());
    else
      cavity.later.push_back(edge<0>(last));
    search(first, last);
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
  found.later.clear();
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
