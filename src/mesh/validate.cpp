#include "dovetail/mesh/validate.hpp"

#include "dovetail/geometry/predicates.hpp"

#include <fmt/core.h>

namespace dovetail {
namespace {

constexpr std::size_t position(LocalIndex i) { return static_cast<std::size_t>(i); }
constexpr std::size_t corner_after(std::size_t i) { return i == 2 ? 0 : i + 1; }
constexpr std::size_t corner_before(std::size_t i) { return i == 0 ? 2 : i - 1; }

std::string text_of(Point p) { return fmt::format("({}, {})", p.x, p.y); }

/// A side and its two ends: `from` to `to` is counter-clockwise as seen from its triangle.
struct Side {
  LocalIndex from;
  LocalIndex to;
  LocalIndex neighbour;
};

Side side_of(const Triangulation &mesh, LocalIndex triangle, std::size_t side) {
  const std::size_t base = 3 * position(triangle);
  return {mesh.corners[base + corner_after(side)], mesh.corners[base + corner_before(side)],
          mesh.neighbours[base + side]};
}

/// The side of `triangle` that runs from `from` to `to`, or 3.
std::size_t find_side(const Triangulation &mesh, LocalIndex triangle, LocalIndex from, LocalIndex to) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Side side = side_of(mesh, triangle, i);
    if (side.from == from && side.to == to)
      return i;
  }
  return 3;
}

class Validation {
public:
  Validation(std::span<const Point> sites, const Triangulation &mesh, std::size_t faults_kept)
      : sites_(sites), mesh_(mesh), faults_kept_(faults_kept) {}

  FaultReport run() {
    if (!layout_is_sound(sites_.size(), mesh_)) {
      add(FaultKind::layout, none, "corners and neighbours do not fit each other or the sites");
      return std::move(report_);
    }
    if (mesh_.triangle_count() == 0) {
      check_collinear();
      return std::move(report_);
    }
    check_triangles();
    check_boundary();
    check_counts();
    return std::move(report_);
  }

private:
  void add(FaultKind kind, LocalIndex triangle, std::string text) {
    ++report_.fault_count;
    ++report_.faults_by_kind[static_cast<std::size_t>(kind)];
    if (report_.first_faults.size() < faults_kept_)
      report_.first_faults.push_back({kind, triangle, std::move(text)});
  }

  Point site(LocalIndex v) const { return sites_[position(v)]; }

  void check_collinear() {
    for (std::size_t i = 2; i < sites_.size(); ++i)
      if (exact::orientation(sites_[0], sites_[1], sites_[i]) != Sign::zero) {
        add(FaultKind::collinear, none,
            fmt::format("no triangles, but sites 0, 1 and {} are not on one line", i));
        return;
      }
  }

  void check_triangles() {
    used_.assign(sites_.size(), false);
    boundary_next_.assign(sites_.size(), none);
    for (LocalIndex t = 0; t < mesh_.triangle_count(); ++t) {
      const bool oriented = is_counter_clockwise(sites_, mesh_, t);
      if (!oriented)
        add(FaultKind::orientation, t, "not counter-clockwise");
      for (std::size_t i = 0; i < 3; ++i)
        check_side(t, i, oriented);
    }
  }

  void check_side(LocalIndex t, std::size_t i, bool oriented) {
    const Side side = side_of(mesh_, t, i);
    used_[position(side.from)] = true;
    if (side.neighbour == none) {
      ++report_.hull_edges;
      if (boundary_next_[position(side.from)] != none)
        add(FaultKind::hull, t, fmt::format("two boundary edges leave site {}", side.from));
      boundary_next_[position(side.from)] = side.to;
      boundary_start_ = side.from;
      return;
    }
    if (!adjacency_is_symmetric(mesh_, t, static_cast<int>(i))) {
      add(FaultKind::adjacency, t,
          fmt::format("triangle {} beyond side {} (sites {}, {}) does not answer it", side.neighbour, i,
                      side.from, side.to));
      return;
    }
    if (t > side.neighbour)
      return; // looked at from the other side
    ++report_.inner_edges;
    const std::size_t back = find_side(mesh_, side.neighbour, side.to, side.from);
    const LocalIndex apex = mesh_.corners[3 * position(side.neighbour) + back];
    const std::size_t base = 3 * position(t);
    if (oriented && !is_locally_delaunay(site(mesh_.corners[base]), site(mesh_.corners[base + 1]),
                                         site(mesh_.corners[base + 2]), site(apex)))
      add(FaultKind::delaunay, t,
          fmt::format("site {} {} beyond side {} is inside its circle", apex, text_of(site(apex)), i));
  }

  /// Every vertex on the boundary is left once (checked with the sides); is it one cycle, and convex?
  void check_boundary() {
    if (boundary_start_ == none) {
      add(FaultKind::hull, none, "there is no boundary");
      return;
    }
    std::vector<Point> cycle;
    LocalIndex at = boundary_start_;
    do {
      cycle.push_back(site(at));
      at = boundary_next_[position(at)];
    } while (at != none && at != boundary_start_ && cycle.size() <= sites_.size());
    if (at != boundary_start_) {
      add(FaultKind::hull, none, "the boundary is not closed");
      return;
    }
    if (cycle.size() != static_cast<std::size_t>(report_.hull_edges))
      add(FaultKind::hull, none,
          fmt::format("a cycle of {} edges is not the whole boundary of {}", cycle.size(),
                      report_.hull_edges));
    if (std::string fault = fault_of_boundary(cycle); !fault.empty())
      add(FaultKind::hull, none, std::move(fault));
  }

  void check_counts() {
    for (std::size_t v = 0; v < sites_.size(); ++v)
      if (!used_[v])
        add(FaultKind::unused_site, none, fmt::format("site {} {} is in no triangle", v, text_of(sites_[v])));
    const GlobalIndex expected = 2 * static_cast<GlobalIndex>(sites_.size()) - 2 - report_.hull_edges;
    if (mesh_.triangle_count() != expected)
      add(FaultKind::euler, none,
          fmt::format("{} triangles where {} sites and {} hull edges call for {}", mesh_.triangle_count(),
                      sites_.size(), report_.hull_edges, expected));
  }

  std::span<const Point> sites_;
  const Triangulation &mesh_;
  std::size_t faults_kept_;
  std::vector<bool> used_;
  std::vector<LocalIndex> boundary_next_; ///< by site: the end of the boundary edge that leaves it
  LocalIndex boundary_start_ = none;
  FaultReport report_;
};

} // namespace

std::string_view name_of(FaultKind kind) {
  static constexpr std::array<std::string_view, fault_kinds> names{
      "layout", "orientation", "adjacency", "delaunay", "hull", "euler", "unused_site", "collinear"};
  return names[static_cast<std::size_t>(kind)];
}

bool layout_is_sound(std::size_t vertex_count, const Triangulation &mesh) {
  if (mesh.corners.size() % 3 != 0 || mesh.neighbours.size() != mesh.corners.size())
    return false;
  for (const LocalIndex v : mesh.corners)
    if (v < 0 || position(v) >= vertex_count)
      return false;
  for (const LocalIndex t : mesh.neighbours)
    if (t != none && (t < 0 || t >= mesh.triangle_count()))
      return false;
  return true;
}

bool is_counter_clockwise(std::span<const Point> vertices, const Triangulation &mesh, LocalIndex triangle) {
  const std::size_t base = 3 * position(triangle);
  return exact::orientation(vertices[position(mesh.corners[base])],
                            vertices[position(mesh.corners[base + 1])],
                            vertices[position(mesh.corners[base + 2])]) == Sign::positive;
}

bool adjacency_is_symmetric(const Triangulation &mesh, LocalIndex triangle, int side) {
  const Side here = side_of(mesh, triangle, static_cast<std::size_t>(side));
  if (here.neighbour == none)
    return true;
  if (here.neighbour == triangle)
    return false;
  const std::size_t back = find_side(mesh, here.neighbour, here.to, here.from);
  return back < 3 && mesh.neighbours[3 * position(here.neighbour) + back] == triangle;
}

bool is_locally_delaunay(Point a, Point b, Point c, Point d) {
  return exact::in_circle(a, b, c, d) != Sign::positive;
}

std::string fault_of_boundary(std::span<const Point> cycle) {
  if (cycle.size() < 3)
    return "the boundary has fewer than three edges";
  int summits = 0;
  for (std::size_t i = 0; i < cycle.size(); ++i) {
    const Point u = cycle[i];
    const Point v = cycle[(i + 1) % cycle.size()];
    const Point w = cycle[(i + 2) % cycle.size()];
    const bool ascends = lexicographically_less(u, v);
    const bool ascends_after = lexicographically_less(v, w);
    if (ascends && !ascends_after)
      ++summits;
    const Sign turn = exact::orientation(u, v, w);
    if (turn == Sign::negative)
      return fmt::format("the boundary turns right at {}", text_of(v));
    if (turn == Sign::zero && ascends != ascends_after)
      return fmt::format("the boundary turns back at {}", text_of(v));
  }
  if (summits != 1)
    return fmt::format("the boundary winds {} times", summits);
  return {};
}

FaultReport validate(std::span<const Point> sites, const Triangulation &mesh, std::size_t faults_kept) {
  return Validation(sites, mesh, faults_kept).run();
}

} // namespace dovetail
