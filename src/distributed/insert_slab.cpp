// A slab grows: its triangles are completed to those of all its sites, what is new is inserted, and what is
// not between its lines goes.
#include "growing_slab.hpp"

#include "dovetail/distributed/triangulate_region.hpp"
#include "dovetail/mesh/cavity.hpp"
#include "dovetail/mesh/checksum.hpp"
#include "dovetail/mesh/divide_and_conquer.hpp"
#include "dovetail/mesh/space_filling_order.hpp"
#include "open_sides.hpp"
#include "slab_completion.hpp"
#include "triangle_hints.hpp"

#include <fmt/format.h>

#include <cmath>

namespace dovetail::insertion {
namespace {

/// A walk through a Delaunay mesh meets no triangle twice (mesh/locate.hpp). As nothing is locked, this
/// predicate only counts, and makes sure that the triangles on both sides of an edge agree on it before the
/// walk steps across.
struct WalkLimit {
  const Triangulation &triangles;
  mutable LocalIndex steps = 0;
  bool operator()(LocalIndex triangle, int side) const {
    if (++steps > triangles.triangle_count())
      refuse_mesh(fmt::format("triangle {} of a slab", triangle), "is not Delaunay: a walk does not end");
    sound_twin(triangles, half_edge(triangle, side));
    return false;
  }
};

/// Nothing is locked; but wherever a cavity's search looks, the triangles on both sides of an edge must agree
/// on it, and be counter-clockwise. Then the search ends, and what it finds can be replaced, even in a mesh
/// that is broken elsewhere.
struct SoundSides {
  const std::vector<Point> &points;
  const Triangulation &triangles;

  bool operator()(LocalIndex triangle, int side) const {
    const HalfEdge beyond = sound_twin(triangles, half_edge(triangle, side));
    if (beyond != none)
      require_counter_clockwise(triangle_of(beyond));
    return false;
  }

  void require_counter_clockwise(LocalIndex triangle) const {
    const LocalIndex *corner = &triangles.corners[3 * at(triangle)];
    if (orientation(points[at(corner[0])], points[at(corner[1])], points[at(corner[2])]) != Sign::positive)
      refuse_mesh(fmt::format("triangle {} of a slab", triangle), "is not counter-clockwise");
  }
};

/// Inserts vertices into the triangles of a slab, and keeps account of what that changes.
class SlabInsertion {
public:
  explicit SlabInsertion(GrowingSlab &slab)
      : points_(slab.points()), triangles_(slab.triangles()),
        hints_(points_, triangles_, std::span(points_).subspan(at(slab.first_new()))) {}

  /// Looks where all of them lie before the first is inserted: `vertices` should be so few that this stays in
  /// the cache, and that the triangles around most of them are still the same when it is their turn.
  void insert(std::span<const LocalIndex> vertices) {
    std::vector<Point> sites;
    std::ranges::transform(vertices, std::back_inserter(sites), [&](LocalIndex v) { return points_[at(v)]; });
    const std::vector<LocalIndex> hints = hints_.near(points_, triangles_, sites);
    for (std::size_t i = 0; i < vertices.size(); ++i)
      insert(vertices[i], hints[i]);
  }

  std::uint64_t checksum_change() const { return checksum_change_; }
  /// Triangles that have been made; some of them may be gone again.
  std::span<const LocalIndex> changed() const { return changed_; }

private:
  void insert(LocalIndex vertex, LocalIndex hint) {
    const Point site = points_[at(vertex)];
    const LocalIndex begin = distance(last_, site) < distance(hint, site) ? last_ : hint;
    const Place place = locate(points_, triangles_, site, begin, WalkLimit{triangles_});
    if (place.kind == PlaceKind::vertex)
      refuse_mesh(fmt::format("triangle {} of a slab", place.triangle), "has a corner that is no site");
    const SoundSides sound{points_, triangles_};
    sound.require_counter_clockwise(place.triangle);
    if (place.kind == PlaceKind::outside)
      require_sound_hull(half_edge(place.triangle, place.side), site);
    find_cavity(points_, triangles_, site, place, cavity_, sound);
    count(cavity_.triangles, false);
    const LocalIndex first_new = commit(triangles_, cavity_, vertex);
    star_.clear();
    for (std::size_t e = 0; e < cavity_.edges.size(); ++e)
      star_.push_back(star_triangle(cavity_, first_new, e));
    count(star_, true);
    changed_.insert(changed_.end(), star_.begin(), star_.end());
    last_ = star_.front();
  }

  /// Between a corner of the triangle and the site: good for a guess.
  double distance(LocalIndex triangle, Point site) const {
    const Point corner = points_[at(triangles_.corners[3 * at(triangle)])];
    return std::max(std::fabs(corner.x - site.x), std::fabs(corner.y - site.y));
  }

  void count(std::span<const LocalIndex> triangles, bool added) {
    corners_.clear();
    for (const LocalIndex t : triangles)
      for (std::size_t i = 0; i < 3; ++i)
        corners_.push_back(triangles_.corners[3 * at(t) + i]);
    const std::uint64_t sum = checksum_of_triangles(points_, corners_);
    checksum_change_ += added ? sum : 0 - sum;
  }

  /// The hull edges that a site outside sees must follow each other, and not all be seen.
  void require_sound_hull(HalfEdge seen, Point site) const {
    const auto sees = [&](HalfEdge h) {
      return orientation(points_[at(origin(triangles_, h))], points_[at(target(triangles_, h))], site) ==
             Sign::negative;
    };
    LocalIndex steps = 0;
    const auto follow = [&](auto &&next) {
      for (HalfEdge h = next(triangles_, seen); sees(h); h = next(triangles_, h))
        if (++steps > triangles_.triangle_count())
          refuse_mesh(fmt::format("triangle {} of a slab", triangle_of(h)),
                      "is on a hull that is not convex");
    };
    follow(open_side_after);
    follow(open_side_before);
  }

  const std::vector<Point> &points_;
  Triangulation &triangles_;
  Cavity cavity_;
  TriangleHints hints_;
  LocalIndex last_ = 0; ///< a triangle of the vertex inserted last
  std::vector<LocalIndex> star_, corners_, changed_;
  std::uint64_t checksum_change_ = 0;
};

/// What has become of a slab's triangles.
struct NewTriangles {
  std::vector<LocalIndex> outside; ///< its lines, ascending
  std::uint64_t checksum_change = 0;
};

bool is_outside(const GrowingSlab &slab, const SlabLines &lines, const LocalIndex *corners) {
  const auto &points = slab.points();
  return slab.may_be_outside(corners) &&
         !lines.hold_circumcenter(points[at(corners[0])], points[at(corners[1])], points[at(corners[2])]);
}

/// A slab that is made anew meets none of its old triangles, and what is wrong with them would stay in the
/// sum that is the checksum. So all are looked at: whether they are counter-clockwise, agree on the edges
/// between them and are locally Delaunay.
void require_delaunay(const GrowingSlab &slab, const Triangulation &triangles) {
  const std::vector<Point> &points = slab.points();
  const SoundSides sound{points, triangles};
  constexpr LocalIndex ahead = 32;
  for (LocalIndex t = 0; t < triangles.triangle_count(); ++t) {
    // The corners of one that comes later, and those across from it. Written out here: gcc takes calls of
    // what does nothing but fetch for calls of what does nothing.
    const LocalIndex later = std::min(t + ahead, triangles.triangle_count() - 1);
    for (HalfEdge h = half_edge(later, 0); h < half_edge(later, 3); ++h) {
      __builtin_prefetch(&points[at(apex(triangles, h))]);
      const LocalIndex beyond = std::max(triangles.neighbours[at(h)], LocalIndex{0});
      const auto across = at(third_corner(triangles, beyond, origin(triangles, h), target(triangles, h)));
      __builtin_prefetch(&points[std::min(across, points.size() - 1)]); // they may disagree
    }
    sound.require_counter_clockwise(t);
    const LocalIndex *corner = &triangles.corners[3 * at(t)];
    for (int side = 0; side < 3; ++side) {
      const HalfEdge beyond = sound_twin(triangles, half_edge(t, side));
      if (beyond != none && triangle_of(beyond) > t && // both circles hold an apex, or neither does
          in_circle(points[at(corner[0])], points[at(corner[1])], points[at(corner[2])],
                    points[at(apex(triangles, beyond))]) == Sign::positive)
        refuse_mesh(fmt::format("triangle {} of a slab", t), "is not Delaunay");
    }
  }
}

/// All sites are triangulated from scratch.
NewTriangles triangulate_anew(GrowingSlab &slab, const SlabLines &lines) {
  Triangulation &triangles = slab.triangles();
  NewTriangles result;
  require_delaunay(slab, triangles);
  result.checksum_change -= checksum_of_triangles(slab.points(), triangles.corners);
  triangles = delaunay(slab.points());
  result.checksum_change += checksum_of_triangles(slab.points(), triangles.corners);
  for (LocalIndex t = 0; t < triangles.triangle_count(); ++t)
    if (is_outside(slab, lines, &triangles.corners[3 * at(t)]))
      result.outside.push_back(t);
  return result;
}

/// Into triangles of which those from `beyond` on are beyond the slab's lines.
NewTriangles insert_new_vertices(GrowingSlab &slab, LocalIndex beyond, const SlabLines &lines) {
  Triangulation &triangles = slab.triangles();
  NewTriangles result;
  result.checksum_change += checksum_of_triangles(
      slab.points(), std::span(std::as_const(triangles.corners)).subspan(3 * at(beyond)));
  SlabInsertion insertion(slab);
  std::vector<LocalIndex> order = space_filling_order(std::span(slab.points()).subspan(at(slab.first_new())));
  for (LocalIndex &vertex : order)
    vertex += slab.first_new();
  constexpr std::size_t at_a_time = 1024;
  for (std::size_t begin = 0; begin < order.size(); begin += at_a_time)
    insertion.insert(
        std::span(std::as_const(order)).subspan(begin, std::min(at_a_time, order.size() - begin)));
  result.checksum_change += insertion.checksum_change();

  std::vector<LocalIndex> suspicious;
  std::ranges::copy_if(insertion.changed(), std::back_inserter(suspicious),
                       [&](LocalIndex t) { return t < beyond; });
  std::ranges::sort(suspicious);
  suspicious.erase(std::unique(suspicious.begin(), suspicious.end()), suspicious.end());
  for (LocalIndex t = beyond; t < triangles.triangle_count(); ++t)
    suspicious.push_back(t);
  std::ranges::copy_if(suspicious, std::back_inserter(result.outside),
                       [&](LocalIndex t) { return is_outside(slab, lines, &triangles.corners[3 * at(t)]); });
  return result;
}

std::uint64_t checksum_of(const GrowingSlab &slab, const Triangulation &triangles,
                          std::span<const LocalIndex> numbers) {
  std::vector<LocalIndex> corners;
  for (const LocalIndex t : numbers)
    for (std::size_t i = 0; i < 3; ++i)
      corners.push_back(triangles.corners[3 * at(t) + i]);
  return checksum_of_triangles(slab.points(), corners);
}

/// Takes the triangles out, and returns the open sides of what remains.
std::vector<LocalIndex> keep_inside(Triangulation &triangles, std::span<const LocalIndex> outside) {
  const LocalIndex count = triangles.triangle_count() - static_cast<LocalIndex>(outside.size());
  // Open sides are on those beside what goes; of these the last move to the places of the first that go.
  std::vector<LocalIndex> suspicious;
  for (const LocalIndex t : outside)
    for (std::size_t i = 0; i < 3; ++i)
      suspicious.push_back(triangles.neighbours[3 * at(t) + i]);
  suspicious.insert(suspicious.end(), outside.begin(), outside.end());
  remove_triangles(triangles, outside);
  std::vector<LocalIndex> open;
  for (const LocalIndex t : suspicious)
    for (HalfEdge side = 3 * t; t != none && t < count && side < 3 * t + 3; ++side)
      if (triangles.neighbours[at(side)] == none)
        open.push_back(side);
  // Every piece of a slab has a border on it, unless it is the whole mesh.
  return open.empty() ? open_sides(triangles) : open_sides_around(triangles, open);
}

/// Paths and triangles are made apart, so that what is wrong with a mesh, or with us, shows here (F9).
void check_count(const SlabMesh &mesh, const Growth &growth) {
  const auto own = std::span(mesh.vertices.points).first(at(mesh.own_count));
  const GlobalIndex expected =
      triangles_between(own, mesh.first_site, growth.paths.left, growth.paths.right, growth.axis);
  if (mesh.triangles.triangle_count() != expected)
    refuse_mesh(fmt::format("slab {}", growth.slab),
                fmt::format("has not the triangles that its sites and paths call for: it came to {} where "
                            "there must be {}",
                            mesh.triangles.triangle_count(), expected));
}

} // namespace

GrownSlab grow_slab(SlabMesh &mesh, const Growth &growth) {
  GrowingSlab slab(mesh, growth);
  Triangulation &triangles = slab.triangles();
  const LocalIndex own_triangles = triangles.triangle_count();
  const auto added = static_cast<GlobalIndex>(growth.placement.count(growth.k));
  // From so many on, triangulating all is faster than inserting: 0.4 microseconds for each of all sites, both
  // checksums and a look at every old triangle included, against 1.8 for each new one.
  const bool anew = 4 * added > mesh.own_count;
  if (!anew)
    complete_slab(slab, growth.paths, growth.lines);
  const bool has_triangles = triangles.triangle_count() > 0; // or all sites so far are collinear
  const NewTriangles made = anew || !has_triangles ? triangulate_anew(slab, growth.lines)
                                                   : insert_new_vertices(slab, own_triangles, growth.lines);
  GrownSlab grown;
  grown.checksum_change = made.checksum_change - checksum_of(slab, triangles, made.outside) +
                          checksum_of_sites(growth.placement.points(growth.k));
  grown.open_sides = keep_inside(triangles, made.outside);
  mesh.border_sides.clear();
  slab.settle();
  check_count(mesh, growth);
  return grown;
}

} // namespace dovetail::insertion
