/// The merge of Guibas and Stolfi over triangles with ghosts. Private to divide and conquer.
///
/// Two parts that a line separates are zipped from the lower tangent to the upper one (lower and upper as
/// seen with the separating direction to the right). The base l -> r is always a Delaunay edge of the union,
/// and all below it is done. Beyond the base lies the seam, between two chains of edges:
///
///         left chain            right chain
///                \    seam    /                  Every edge of a chain has behind it (away from the seam)
///      left apex  \          /   right apex      a triangle of its part with its apex, or a ghost, and in
///           .      p        q      .             front of it one triangle that is to be replaced: at first
///                  |\      /|                    the ghost of a hull edge.
///                  | \    / |
///                  |  l--r  |                    p is the next site of the left chain, q of the right.
///                      ^ below
///
/// Each turn of the loop does one of these:
///   - p is above the base and the left apex is inside the circle of l, r, p: the triangle behind l -> p
///     cannot stay. Uncover it: the chain now goes l, apex, p. One edge and one triangle more are in front.
///   - the same on the right.
///   - otherwise the circle of l, r and p (or q) is empty; of two such the one that has the other site inside
///     is not. Zip: the triangle in front of the edge becomes l, r, p; its upper side is the next base.
///   - neither p nor q is above the base: it is the upper tangent.
/// Triangles in front balance with edges of the chains, so the new triangles always find their places, and
/// just the two ghosts of the tangents are new.
///
/// Why uncovering needs no test that the apex is above the base: below the base, the circle of l, r and a p
/// above lies within the empty circle that certified the base.
///
/// What is fast about it, with what each trick gained of the instructions and mispredicted branches of a
/// point (100,000 uniform points, as tools/bench count counts; all merges are about half of 1000 and two
/// thirds of 6):
///   - All that a step asks about p, q and both apexes is answered in two lanes at once, and one test says
///     whether all four signs are certain. After a step only the lane of the side that moved is loaded again,
///     and what was the apex is the next site (-60 instructions).
///   - One branch decides between left and right, where first "are both above?" was one of its own
///     (-1.0 mispredictions); which half-edge comes before another is computed, not branched on (-0.3).
///   - Corners stand across from half-edges: the apex behind an edge is at the edge itself (-30 instructions,
///     and two steps less in the chain of loads that everything waits for).
///   - The first line of the filter is one pair of bounds for the whole merge: sight.hpp.
///
/// What a merge needs of its parts: some direction, perhaps infinitesimally turned, puts all of the left
/// before all of the right, and the vertex of the left that comes last in this direction and that of the
/// right that comes first are given. The orders (x, y) and (y, x) are such directions, the x axis and the
/// y axis turned infinitesimally towards each other; everything else is decided by orientations, which know
/// no axes.
#pragma once

#include "sphere.hpp"

namespace dovetail::divide_and_conquer {

/// The lowest edge of a chain. side 0 is the left chain, side 1 the right one. Always:
/// inner = twin[front], next is the upper end of this edge, apex = corner[inner].
struct Rim {
  HalfEdge front; ///< the triangle to be replaced; it has the layout of a ghost
  HalfEdge inner; ///< the half-edge behind it: from l to next, or from next to r
  Vertex next;
  Vertex apex;
};

/// The half-edge of a ghost that leads up the chain, from ghost to ghost: the left chain is followed as the
/// hull is, counter-clockwise, the right one clockwise. In a new triangle l, r, next it is the side on the
/// chain.
template <unsigned side> inline constexpr HalfEdge link = side == 0 ? 2 : 1;

template <class Sites> struct Seam {
  const Sphere<Sites> sphere;          ///< a copy: its addresses stay in registers
  Pair next_x, next_y, apex_x, apex_y; ///< where they are, left and right

  /// Looks behind the chain.
  template <unsigned side> void survey(Rim &rim) {
    rim.next = sphere.corner[rim.front + 1 + static_cast<HalfEdge>(side)];
    rim.inner = sphere.twin[rim.front];
    const Point at_next = sphere.site[rim.next];
    next_x[side] = at_next.x;
    next_y[side] = at_next.y;
    look_at_apex<side>(rim);
  }

  template <unsigned side> void look_at_apex(Rim &rim) {
    rim.apex = sphere.corner[rim.inner];
    const Point at_apex = sphere.site[rim.apex];
    apex_x[side] = at_apex.x;
    apex_y[side] = at_apex.y;
  }

  /// Opens the triangle behind: it takes the place in front of the edge to its apex, and what was in front
  /// before stays in front of the edge from there to `next`. `end` is l or r.
  template <unsigned side> void uncover(Rim &rim, Vertex end) {
    const HalfEdge behind = sphere.triangle_of(rim.inner);
    const HalfEdge before = sphere.before(rim.inner, behind);
    const HalfEdge after = 3 * behind + 3 - rim.inner - before; // the three are 0, 1 and 2 more than `behind`
    const HalfEdge inner = sphere.twin[side == 0 ? before : after];
    sphere.join(rim.front, sphere.twin[side == 0 ? after : before]);
    sphere.join(behind, inner);
    if constexpr (side == 0)
      sphere.set_ghost(behind, end, rim.apex);
    else
      sphere.set_ghost(behind, rim.apex, end);
    sphere.twin[behind + link<side>] = narrow(rim.front + 3 - link<side>);
    rim.front = behind;
    rim.inner = inner;
    rim.next = rim.apex;
    next_x[side] = apex_x[side];
    next_y[side] = apex_y[side];
    look_at_apex<side>(rim);
  }

  /// Makes the triangle in front l, r, next and goes on along the chain. `below` is its side next to be built
  /// on.
  template <unsigned side> void zip(Rim &rim, Vertex l, Vertex r, HalfEdge &below) {
    const HalfEdge triangle = rim.front;
    rim.front = sphere.twin[triangle + link<side>] - (3 - link<side>);
    sphere.set_corners(triangle, rim.next, l, r);
    sphere.join(triangle, below);
    sphere.join(triangle + link<side>, rim.inner);
    below = triangle + 3 - link<side>;
  }
};

/// Whose next site is zipped: of the only one that is above the base, or of the winner. Without a branch: one
/// of two outcomes, of which neither is likely, is enough for the processor to guess.
inline bool takes_right(unsigned below_base, unsigned left_wins) {
  constexpr unsigned right = 0b001101; // bit 2 * below_base + left_wins
  return (right >> (2 * below_base + left_wins) & 1) != 0;
}

/// The ghosts that begin at the ends of the lower tangent: all `left` must come before all `right`.
struct Tangent {
  HalfEdge left;
  HalfEdge right;
};

/// From a pair of vertices that certainly see each other downwards. While the next vertex down the left hull
/// is below l -> r, it becomes l; otherwise the same on the right. Both are looked at together, but only one
/// moves: the other may be above the new line. Ties stay at the nearer vertex, so that no site lies on the
/// tangent between its ends.
template <class Sites>
Tangent lower_tangent(const Sphere<Sites> &sphere, HalfEdge left, HalfEdge right, double height_bound) {
  const Pair bound{height_bound, height_bound};
  Vertex l = sphere.begin_of(left), r = sphere.begin_of(right);
  Point at = sphere.site[l];
  Pair lx{at.x, at.x}, ly{at.y, at.y};
  at = sphere.site[r];
  Pair rx{at.x, at.x}, ry{at.y, at.y};
  HalfEdge before = sphere.ghost_before(left);
  Vertex next_l = sphere.begin_of(before), next_r = sphere.end_of(right);
  const Point at_next_l = sphere.site[next_l], at_next_r = sphere.site[next_r];
  Pair next_x{at_next_l.x, at_next_r.x}, next_y{at_next_l.y, at_next_r.y};
  for (;;) {
    const Pair height = look(next_x, next_y, lx, ly, rx, ry).im;
    unsigned below = negative_lanes(height);
    if (!all_lanes_beyond(height, bound)) [[unlikely]]
      below = (sphere.turn(l, r, next_l) == Sign::negative ? 1U : 0U) |
              (sphere.turn(l, r, next_r) == Sign::negative ? 2U : 0U);
    if ((below & 1) != 0) {
      left = before;
      l = next_l;
      lx = Pair{next_x[0], next_x[0]};
      ly = Pair{next_y[0], next_y[0]};
      before = sphere.ghost_before(left);
      next_l = sphere.begin_of(before);
      at = sphere.site[next_l];
      next_x[0] = at.x;
      next_y[0] = at.y;
    } else if (below != 0) {
      right = sphere.ghost_after(right);
      r = next_r;
      rx = Pair{next_x[1], next_x[1]};
      ry = Pair{next_y[1], next_y[1]};
      next_r = sphere.end_of(right);
      at = sphere.site[next_r];
      next_x[1] = at.x;
      next_y[1] = at.y;
    } else {
      return {left, right};
    }
  }
}

/// Zips two parts together. Every site of `left` must come before every site of `right` in the order of
/// `axis`; `spare` is the first of the two free triangles.
template <class Sites>
Hull Sphere<Sites>::merge(const Hull &left, const Hull &right, unsigned axis, HalfEdge spare) const {
  return axis == 0 ? merge_along<0>(left, right, spare) : merge_along<1>(left, right, spare);
}

/// Long because it is one state machine, whose state (both rims, the base, their coordinates in registers) is
/// what every step reads and writes.
template <class Sites>
template <unsigned axis>
Hull Sphere<Sites>::merge_along(const Hull &left, const Hull &right, HalfEdge spare) const {
  constexpr unsigned other = 1 - axis;
  // The extremes of the union. Along the cut they are known; only in the other order must sites be compared.
  const bool first_is_left =
      less_along(site[begin_of(left.first[other])], site[begin_of(right.first[other])], other);
  const bool last_is_left =
      less_along(site[begin_of(right.last[other])], site[begin_of(left.last[other])], other);
  Hull hull;
  hull.first[axis] = left.first[axis];
  hull.last[axis] = right.last[axis];
  hull.first[other] = first_is_left ? left.first[other] : right.first[other];
  hull.last[other] = last_is_left ? left.last[other] : right.last[other];
  const Vertex first_axis = begin_of(hull.first[axis]), first_other = begin_of(hull.first[other]);
  const Vertex last_axis = begin_of(hull.last[axis]), last_other = begin_of(hull.last[other]);
  const Point low_axis = site[first_axis], high_axis = site[last_axis];
  const Point low_other = site[first_other], high_other = site[last_other];
  const double width = axis == 0 ? high_axis.x - low_axis.x : high_axis.y - low_axis.y;
  const double height = axis == 0 ? high_other.y - low_other.y : high_other.x - low_other.x;
  const double greatest_z = width * width + height * height;
  const Bounds bounds = filter.bounds(greatest_z, greatest_z);
  const Pair height_bound{bounds.height, bounds.height};
  const Pair circle_bound{bounds.circle, bounds.circle};

  const Tangent tangent = lower_tangent(*this, left.last[axis], right.first[axis], bounds.height);
  const HalfEdge hull_before = ghost_before(tangent.left);
  const HalfEdge bottom = spare;
  const HalfEdge top = spare + 3;
  const Vertex bottom_l = begin_of(tangent.left);
  Vertex l = bottom_l;
  Vertex r = begin_of(tangent.right);
  Rim rim_l{}, rim_r{};
  rim_l.front = tangent.left;
  rim_r.front = ghost_before(tangent.right);
  // A part that is a mere segment can be used up on both sides, back to where it began. Its chain then comes
  // to the bottom ghost, whose far vertex is never above the base.
  set_ghost(bottom, l, r);
  twin[bottom] = narrow(bottom);
  chain(hull_before, bottom);
  chain(bottom, tangent.right);
  HalfEdge below = bottom;

  Seam<Sites> seam{*this, {}, {}, {}, {}};
  seam.template survey<0>(rim_l);
  seam.template survey<1>(rim_r);
  const auto both = [](double value) { return Pair{value, value}; };
  const Point at_l = site[l], at_r = site[r];
  Pair lx = both(at_l.x), ly = both(at_l.y), rx = both(at_r.x), ry = both(at_r.y);
  for (;;) {
    const SightPair next = look(seam.next_x, seam.next_y, lx, ly, rx, ry);
    const SightPair apex = look(seam.apex_x, seam.apex_y, lx, ly, rx, ry);
    const Pair circle = circle_determinant(next, apex);
    unsigned below_base = negative_lanes(next.im);
    unsigned inside = 3 & ~(below_base | negative_lanes(circle));
    if (!all_lanes_beyond(next.im, height_bound, circle, circle_bound)) [[unlikely]] {
      unsigned unsure = 3 & ~lanes_beyond(circle, circle_bound);
      if (lanes_beyond(next.im, height_bound) != 3) {
        below_base = (turn(l, r, rim_l.next) == Sign::positive ? 0U : 1U) |
                     (turn(l, r, rim_r.next) == Sign::positive ? 0U : 2U);
        unsure = 3; // the sign of the height is all that tells that infinity is outside
      }
      unsure &= ~below_base;
      inside = 3 & ~(below_base | negative_lanes(circle) | unsure);
      if ((unsure & 1) != 0 && is_inside(l, r, rim_l.next, rim_l.apex))
        inside |= 1;
      if ((unsure & 2) != 0 && is_inside(l, r, rim_r.next, rim_r.apex))
        inside |= 2;
    }
    if (inside != 0) {
      if ((inside & 1) != 0)
        seam.template uncover<0>(rim_l, l);
      if ((inside & 2) != 0)
        seam.template uncover<1>(rim_r, r);
      continue;
    }
    if (below_base == 3)
      break;
    const Pair crossed = next.re * Pair{next.im[1], next.im[0]};
    const Pair left_against_right = crossed - Pair{crossed[1], crossed[0]};
    unsigned left_wins = negative_lanes(left_against_right) & 1;
    if (!(std::fabs(left_against_right[0]) > bounds.circle) && below_base == 0) [[unlikely]]
      left_wins = is_inside(l, r, rim_l.next, rim_r.next) ? 0 : 1;
    if (takes_right(below_base, left_wins)) {
      seam.template zip<1>(rim_r, l, r, below);
      r = rim_r.next;
      rx = both(seam.next_x[1]);
      ry = both(seam.next_y[1]);
      seam.template survey<1>(rim_r);
    } else {
      seam.template zip<0>(rim_l, l, r, below);
      l = rim_l.next;
      lx = both(seam.next_x[0]);
      ly = both(seam.next_y[0]);
      seam.template survey<0>(rim_l);
    }
  }
  set_ghost(top, r, l);
  join(top, below);
  chain(rim_r.front, top);
  chain(top, rim_l.front);

  // A ghost that began at an end of a tangent may be gone; the tangent's own begins there now. (If all sites
  // are collinear the ends of the tangent are no extremes.)
  const auto renewed = [&](HalfEdge ghost, Vertex v) {
    return v == bottom_l ? bottom : v == r ? top : ghost;
  };
  hull.first[axis] = renewed(hull.first[axis], first_axis);
  hull.first[other] = renewed(hull.first[other], first_other);
  hull.last[axis] = renewed(hull.last[axis], last_axis);
  hull.last[other] = renewed(hull.last[other], last_other);
  return hull;
}

} // namespace dovetail::divide_and_conquer
