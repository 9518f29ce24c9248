/// Where a point lies in a mesh: a walk from a triangle given as a hint. Local; reads only.
///
/// Visibility walk (Guibas and Stolfi, 1985; Devillers, Pion and Teillaud, Walking in a triangulation, 2002):
/// from a triangle, cross any side that has the point beyond; never back across the side that one came by.
///
/// Why it ends. Take the power of the point with respect to the circle of the triangle. The circles on both
/// sides of an edge have equal power along its line, and if the edge is locally Delaunay the one ahead has
/// the smaller power beyond; among equals (four on a circle) the perturbation of the canonical rule decides
/// the same way. So the power falls with every step, and no triangle is met twice: not in a Delaunay mesh,
/// and as locked edges are not crossed, not in a constrained one either. More steps than there are triangles
/// are a proof that the mesh is neither, as while it is being flipped; then the choice between two sides is
/// left to chance, and the walk ends with probability one in every triangulation (Devillers, Pion and
/// Teillaud).
///
/// Cost: about one and a half orientations a triangle on the way; from a random triangle to a random point of
/// n uniform sites O(sqrt n) triangles, from a near one O(1).
#pragma once

#include "dovetail/geometry/seen.hpp"
#include "dovetail/mesh/half_edge.hpp"

#include <cassert>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>

namespace dovetail {

enum class PlaceKind : std::uint8_t {
  vertex,  ///< the point equals a vertex of the triangle
  edge,    ///< it is inside a side of it, which may be on the hull
  inside,  ///< it is inside the triangle
  outside, ///< it is beyond a side that has no neighbour, strictly
  blocked, ///< it is beyond a side that is locked, strictly
};

struct Place {
  PlaceKind kind;
  LocalIndex triangle;
  int side; ///< for `vertex` the corner; meaningless for `inside`
};

namespace visibility_walk {

/// `yes` if so is 1, `no` if it is 0; without a branch.
constexpr LocalIndex choose(int so, LocalIndex yes, LocalIndex no) { return no ^ ((yes ^ no) & -so); }

inline Seen reversed(const Seen &seen) {
  return {Pair{seen.x[1], seen.x[0]}, Pair{seen.y[1], seen.y[0]}, Pair{seen.lift[1], seen.lift[0]}};
}

template <class Locked> struct Walk {
  std::span<const Point> sites;
  const Triangulation &mesh;
  Point point;
  const Locked &locked;
  LocalIndex triangle;
  LocalIndex steps_left;    ///< before it is proved that the mesh is not Delaunay
  int entered = none;       ///< a side of `triangle` that has the point inside, strictly: the one crossed
  std::uint32_t chance = 1; ///< its highest bit decides

  Pair see(LocalIndex vertex) const { return dovetail::see(sites[position(vertex)], point); }

  void cross(int side) {
    const LocalIndex ahead = mesh.neighbours[position(half_edge(triangle, side))];
    entered = half_edge_towards(mesh, ahead, triangle) - half_edge(ahead, 0);
    triangle = ahead;
  }

  /// One triangle, in all cases: crosses a side and returns true, or tells the place.
  bool step(Place &place) {
    if (steps_left > 0)
      --steps_left;
    else
      chance = chance * 1664525 + 1013904223; // Knuth's and Lewis's congruential generator
    const int first = entered == none ? 0 : (chance >> 31) == 0 ? side_after(entered) : side_before(entered);
    int closed = none;
    int zeros = 0, on = 0; // how many sides have the point on their lines; the sum of these sides
    for (int k = 0, side = first; k < 3; ++k, side = side_after(side)) {
      if (side == entered)
        continue;
      const HalfEdge h = half_edge(triangle, side);
      const Sign turn =
          orientation(sites[position(origin(mesh, h))], sites[position(target(mesh, h))], point);
      if (turn == Sign::negative) {
        if (mesh.neighbours[position(h)] != none && !locked(triangle, side)) {
          cross(side);
          return true;
        }
        closed = side;
      } else if (turn == Sign::zero) {
        ++zeros;
        on += side;
      }
    }
    if (closed != none)
      place = {mesh.neighbours[position(half_edge(triangle, closed))] == none ? PlaceKind::outside
                                                                              : PlaceKind::blocked,
               triangle, closed};
    else if (zeros == 0)
      place = {PlaceKind::inside, triangle, 0};
    else if (zeros == 1)
      place = {PlaceKind::edge, triangle, on};
    else // two sides meet at the corner across from the third
      place = {PlaceKind::vertex, triangle, 3 - on};
    return false;
  }

  /// Leaves it to `step` to go on, which came by the side between these ends.
  bool stop(LocalIndex one, LocalIndex other) {
    const LocalIndex tip = third_corner(mesh, triangle, one, other);
    entered = side_across(mesh, triangle, tip) - half_edge(triangle, 0);
    return false;
  }

  /// As many steps as the filter decides and nothing bars: each looks at one new corner. Returns true if the
  /// point is inside the triangle at which it ends; otherwise it is for `step` to go on.
  ///
  /// Which side has the point beyond is as good as random, so there is no branch on it: what lies beyond both
  /// is looked up while the turns are computed, and then one of the two is chosen.
  bool stride() {
    const HalfEdge h = half_edge(triangle, entered == none ? 0 : entered);
    // Where h ends and begins: the other two sides go from end[0] to the tip and on to end[1].
    LocalIndex end[2] = {target(mesh, h), origin(mesh, h)};
    Seen seen = both(see(end[0]), see(end[1]));
    if (entered == none) {
      const filter::Bounded turn = filter::turn(reversed(seen), seen);
      if (!(std::fabs(turn.value[0]) > turn.bound[0]))
        return false;
      const LocalIndex ahead = mesh.neighbours[position(h)];
      const auto is_beyond = static_cast<int>(std::signbit(turn.value[0]));
      if ((ahead == none || locked(triangle, 0)) && is_beyond != 0) // hardly ever barred
        return false;
      triangle = choose(is_beyond, ahead, triangle);
      const LocalIndex last = end[0];
      end[0] = choose(is_beyond, end[1], last);
      end[1] = choose(is_beyond, last, end[1]);
      const auto turned = (Pair{turn.value[0], turn.value[0]} < 0);
      const Seen back = reversed(seen);
      seen.x = turned ? back.x : seen.x;
      seen.y = turned ? back.y : seen.y;
    }
    for (; steps_left > 0; --steps_left) {
      const LocalIndex tip = third_corner(mesh, triangle, end[0], end[1]);
      const HalfEdge side[2] = {side_across(mesh, triangle, end[0]), side_across(mesh, triangle, end[1])};
      const LocalIndex beyond[2] = {mesh.neighbours[position(side[0])], mesh.neighbours[position(side[1])]};
      const Pair at = see(tip);
      const Seen tip_seen = both(at, at);
      const filter::Bounded turn = filter::turn(seen, tip_seen);
      const auto decided = absolute(turn.value) > turn.bound;
      if ((decided[0] & decided[1]) == 0)
        return stop(end[0], end[1]);
      const auto first = static_cast<int>(std::signbit(turn.value[0]));
      const auto second = 1 - static_cast<int>(std::signbit(turn.value[1]));
      if (first + second == 0)
        return true;
      const LocalIndex ahead = choose(first, beyond[1], beyond[0]);
      if (ahead == none || locked(triangle, choose(first, side[1], side[0]) - half_edge(triangle, 0)))
        return stop(end[0], end[1]);
      triangle = ahead;
      end[0] = choose(first, end[0], tip);
      end[1] = choose(first, tip, end[1]);
      const auto stays = (Pair{turn.value[0], -turn.value[0]} < 0);
      seen.x = stays ? seen.x : tip_seen.x;
      seen.y = stays ? seen.y : tip_seen.y;
    }
    return stop(end[0], end[1]);
  }
};

} // namespace visibility_walk

/// The place of a point; `hint` is any triangle. On a locked edge is `edge`, at its ends `vertex`. `outside`
/// means outside of the hull where the border is convex; `outside` and `blocked` mean elsewhere that the walk
/// found no open way on. locked(triangle, side) must be the same from both sides of an edge;
/// it is asked of sides that are crossed, and may be of side 0 of the hint in any case.
template <class Locked = NothingLocked>
Place locate(std::span<const Point> sites, const Triangulation &mesh, Point point, LocalIndex hint,
             const Locked &locked = {}) {
  assert(hint >= 0 && hint < mesh.triangle_count());
  visibility_walk::Walk<Locked> walk{sites, mesh, point, locked, hint, mesh.triangle_count()};
  Place place;
  do
    if (walk.stride())
      return {PlaceKind::inside, walk.triangle, 0};
  while (walk.step(place));
  return place;
}

} // namespace dovetail
