/// Boxes of the split-path recursion, and how one is cut in two. Private to mesh.
#pragma once

#include "dovetail/geometry/predicates.hpp"
#include "presorted_sites.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dovetail {

/// A chain of sites: a stretch of the stack that all chains are on. Chains of boxes overlap as they like.
struct Chain {
  std::size_t begin, end;
  std::size_t size() const { return end - begin; }
};

/// A side of a box: its line, and the sites whose cells meet the box on it, ascending along the line.
struct Side {
  double line; ///< infinite where there is none
  Chain chain;
};

/// A box between split lines, its border B and its interior P. Neighbouring sides share the site whose cell
/// holds their corner.
///
///              sides[1][1]           A cut at m along x leaves
///            +-------------+         sides[0][0] to the low half,
///            |      :      |         sides[0][1] to the high half,
/// sides[0][0]|      : m    |[0][1]   the chains of sides[1] in two parts,
///            +-------------+         and its path to both.
///              sides[1][0]
struct Box {
  std::array<std::array<Side, 2>, 2> sides; ///< by axis, low and high
  std::size_t begin, end; ///< P: the same stretch of both orders, which hold the same sites there
  std::size_t interior() const { return end - begin; }
};

/// Where a line leaves a box: the places in the chains it crosses whose cells hold its ends.
struct Ends {
  std::size_t low, high;
};

struct Halves {
  Box low, high;
};

/// Cuts boxes. Both orders are divided in place and stay sorted, and chains are a stack, so a box must be
/// done with before the other half of its parent is cut.
class BoxSplitting {
public:
  explicit BoxSplitting(PresortedSites &&sites);

  std::span<const Point> points() const { return sites_.point; }
  std::span<const LocalIndex> sites(Chain chain) const {
    return std::span(stack_).subspan(chain.begin, chain.size());
  }

  /// The box that holds everything: its chains are the lowest and the highest row and the hull between them,
  /// collinear sites included. O(n).
  Box whole();
  /// P, ascending along the axis; valid until the box is divided.
  std::span<const RankedSite> interior(const Box &box, Axis axis) const {
    return std::span(sites_.order[static_cast<std::size_t>(axis)]).subspan(box.begin, box.interior());
  }
  /// The line through the median of the interior, across its longer side.
  SplitLine middle(const Box &box) const;
  /// O(border).
  Ends ends(const Box &box, SplitLine line) const;
  /// Lays the path between the ends on the stack. O(interior + border) for presorted sites; far less where
  /// sites are spread evenly.
  Chain path(const Box &box, SplitLine line, Ends ends);
  /// The boxes on both sides of the line, without the sites of the path in them. O(interior + path).
  Halves divide(const Box &box, SplitLine line, Ends ends, Chain path);
  /// The boundary of a box, counter-clockwise, every vertex as often as it is come to; valid until the next.
  std::span<const LocalIndex> walk_around(const Box &box);
  /// Takes a path and all above it from the stack.
  void drop(Chain path) { stack_.resize(path.begin); }

private:
  struct HullSite {
    Point point;
    LocalIndex site;
  };
  /// Two consecutive sites of an approximate path, and what lies on or below their chord in the lifted plane.
  struct Chord {
    double low, high; ///< where it begins and ends along the line
    double height, slope;
    double reach_squared; ///< farther from the line nothing is held
    template <Axis axis> bool holds(Point p, double m) const {
      const double distance = across(p, axis) - m, position = along(p, axis) - low;
      return !(distance * distance + position * position > height + slope * position);
    }
  };
  /// Places in the order across the line, which is at the median: its sites are nearer than all others.
  struct Strip {
    std::size_t begin, end;
  };

  struct Ranks {
    LocalIndex begin, end;
  };

  Point point(LocalIndex v) const { return sites_.point[static_cast<std::size_t>(v)]; }
  std::vector<LocalIndex> hull_side(std::array<LocalIndex, 3> corners, std::span<const RankedSite> between,
                                    Sign outside) const;
  std::size_t nearest(const Side &side, SplitLine line) const;
  template <Axis axis> Chain path_across(const Box &box, double m, LocalIndex first, LocalIndex last);
  template <Axis axis> void extend_hull(HullSite next, double m);
  template <Axis axis> Strip approximate(const Box &box, double m, HullSite first, HullSite last);
  template <Axis axis> void set_chords(double m);
  template <Axis axis> std::span<HullSite> find_others(const Box &box, double m, Strip strip);
  template <Axis axis>
  std::size_t consider(std::span<const LocalIndex> candidates, double m, std::size_t found);
  void make_room(std::size_t sites);
  Ranks ranks(std::span<const RankedSite> sites, Axis axis) const;
  void remove(std::span<RankedSite> order, Axis axis);

  PresortedSites sites_;
  std::vector<bool> is_interior_; ///< by site: not on any border so far
  std::vector<LocalIndex> stack_;
  std::vector<RankedSite> scratch_;
  std::vector<LocalIndex> leaving_; ///< of a path, what is in the interior
  std::vector<LocalIndex> walk_;
  std::vector<HullSite> hull_;
  std::vector<HullSite> others_; ///< of which the first few are in use
  std::vector<HullSite> approximate_;
  std::vector<Chord> chords_;
  double reach_squared_ = 0; ///< farther from the line nothing is below any chord
};

} // namespace dovetail
