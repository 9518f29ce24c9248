/// A slab between the old mesh and the new one: its vertices in the order in which they came. Private to
/// distributed. Local.
#pragma once

#include "insertion.hpp"

#include <initializer_list>
#include <utility>
#include <vector>

namespace dovetail::insertion {

/// The vertices of a slab that grows are its old own sites and its ghosts, as they were; the further sites of
/// its old paths; its new own sites; the further sites of its new paths. The first three are the set that the
/// slab's triangles were made from (F4), and from first_new() on they are to be inserted.
class GrowingSlab {
public:
  /// Appends the points to those of the slab. `growth` must outlive it.
  GrowingSlab(SlabMesh &slab, const Growth &growth);

  LocalIndex old_own() const { return slab_.own_count; }
  LocalIndex first_new() const { return first_new_; }
  LocalIndex count() const { return static_cast<LocalIndex>(slab_.vertices.points.size()); }
  const std::vector<Point> &points() const { return slab_.vertices.points; }
  Triangulation &triangles() { return slab_.triangles; }
  const SlabMesh &old_slab() const { return slab_; }

  /// The vertex of a site, by the number that it will have.
  LocalIndex vertex_of(GlobalIndex number) const;

  /// Whether a triangle with these corners may have its circumcenter outside the slab: none has unless each
  /// is on an old or a new path, or foreign.
  bool may_be_outside(const LocalIndex *corners) const {
    return on_path_[at(corners[0])] && on_path_[at(corners[1])] && on_path_[at(corners[2])];
  }

  /// Makes of all this the slab of the new mesh: own sites in the total order, and those ghosts that the
  /// triangles use. One pass over the corners and over every column.
  void settle();

private:
  LocalIndex new_own() const { return old_own() + static_cast<LocalIndex>(arrivals_.places.size()); }
  bool is_own(GlobalIndex number) const { return number >= first_site_ && number < first_site_ + new_own(); }
  /// What the vertices behind the old own ones become: own sites in the total order, then all foreign ones by
  /// number.
  std::vector<LocalIndex> places_behind_own() const;
  /// Notes which vertices are on the path; most of them are on `marked` too, whose are noted already.
  void mark_path(const Path &path, const Path &marked);
  /// Appends those sites of the paths that are not there yet.
  void append_foreign(std::initializer_list<const Path *> paths);
  /// Returns where in the corners the foreign ones are.
  std::vector<std::size_t> renumber_corners();

  SlabMesh &slab_;
  const Growth &growth_;
  SlabArrivals arrivals_;
  GlobalIndex first_site_; ///< that the slab will have
  LocalIndex first_new_ = 0;
  std::vector<std::pair<GlobalIndex, LocalIndex>> foreign_; ///< number and vertex, ascending
  std::vector<bool> on_path_;
};

} // namespace dovetail::insertion
