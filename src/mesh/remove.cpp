#include "dovetail/mesh/remove.hpp"

#include "dovetail/geometry/predicates.hpp"
#include "dovetail/mesh/insert.hpp"
#include "dovetail/mesh/locate.hpp"
#include "dovetail/mesh/space_filling_order.hpp"

#include <algorithm>
#include <cassert>

namespace dovetail {
namespace {

using Hole = RemovalMemory::Hole;

/// A half-edge across from a vertex.
HalfEdge link_edge(std::span<const Point> sites, const Triangulation &mesh, LocalIndex vertex,
                   LocalIndex hint) {
  const Point site = sites[position(vertex)];
  const Place place = locate(sites, mesh, site, hint != none ? hint : jump(sites, mesh, site));
  const HalfEdge h = half_edge(place.triangle, place.side);
  assert(place.kind == PlaceKind::vertex && apex(mesh, h) == vertex);
  return h;
}

/// One site's removal, all but its number.
class Hollow {
public:
  Hollow(std::span<const Point> sites, Triangulation &mesh, RemovalMemory &memory)
      : sites_(sites), mesh_(mesh), memory_(memory) {}

  /// Takes the site across from h out of all triangles. Returns a triangle next to it, or `none`.
  LocalIndex empty_and_fill(HalfEdge h) {
    take_star(h);
    if (memory_.star.closed)
      memory_.holes.push_back({1, last_in_link(), memory_.beyond[0]});
    else
      close_hull();
    std::size_t used = 0;
    while (!memory_.holes.empty()) {
      const Hole hole = memory_.holes.back();
      memory_.holes.pop_back();
      if (hole.last == hole.first + 1)
        join(memory_.beyond[position(hole.first)], hole.outside);
      else
        fill(hole, memory_.slots[used++]);
    }
    return free_slots(used);
  }

private:
  Point site(LocalIndex place) const { return sites_[position(memory_.link[position(place)])]; }
  LocalIndex last_in_link() const { return static_cast<LocalIndex>(memory_.link.size() - 1); }

  void take_star(HalfEdge h) {
    find_star(mesh_, h, memory_.star);
    memory_.slots.clear();
    memory_.link.clear();
    memory_.beyond.clear();
    memory_.link.push_back(origin(mesh_, memory_.star.link.front()));
    for (const HalfEdge edge : memory_.star.link) {
      memory_.slots.push_back(triangle_of(edge));
      memory_.beyond.push_back(twin(mesh_, edge));
      memory_.link.push_back(target(mesh_, edge));
    }
    std::ranges::sort(memory_.slots);
  }

  /// The hull of the link as seen from the site, which sees it from the left; collinear vertices are on it.
  /// Between two of its vertices is a hole, or just an edge of the link.
  void close_hull() {
    std::vector<LocalIndex> &hull = memory_.hull;
    hull.clear();
    for (LocalIndex i = 0; i <= last_in_link(); ++i) {
      while (hull.size() >= 2 &&
             orientation(site(hull[hull.size() - 2]), site(hull.back()), site(i)) == Sign::positive)
        hull.pop_back();
      hull.push_back(i);
    }
    for (std::size_t i = 0; i + 1 < hull.size(); ++i)
      memory_.holes.push_back({hull[i], hull[i + 1], none});
  }

  /// The triangle at the edge from the last to the first vertex of a hole, in slot t.
  ///
  ///           best
  ///          /    \          side 0: from best to last
  ///         /  t   \         side 1: from last to first, where the hole begins
  ///     first <-- last       side 2: from first to best
  void fill(const Hole &hole, LocalIndex t) {
    const Point first = site(hole.first), last = site(hole.last);
    LocalIndex best = none;
    for (LocalIndex i = hole.first + 1; i < hole.last; ++i)
      if (orientation(last, first, site(i)) == Sign::positive &&
          (best == none || in_circle(last, first, site(best), site(i)) == Sign::positive))
        best = i;
    assert(best != none);
    const HalfEdge h = half_edge(t, 0);
    mesh_.corners[position(h)] = memory_.link[position(hole.first)];
    mesh_.corners[position(h + 1)] = memory_.link[position(best)];
    mesh_.corners[position(h + 2)] = memory_.link[position(hole.last)];
    join(h + 1, hole.outside);
    memory_.holes.push_back({hole.first, best, h + 2});
    memory_.holes.push_back({best, hole.last, h});
  }

  /// Makes twins; either may be `none`.
  void join(HalfEdge a, HalfEdge b) {
    if (a != none)
      mesh_.neighbours[position(a)] = b != none ? triangle_of(b) : none;
    if (b != none)
      mesh_.neighbours[position(b)] = a != none ? triangle_of(a) : none;
  }

  /// Moves the last triangles into the slots behind the first `used`. Returns a triangle near.
  LocalIndex free_slots(std::size_t used) {
    LocalIndex near = used > 0 ? memory_.slots[0] : triangle_beyond();
    LocalIndex count = mesh_.triangle_count();
    memory_.triangles_moved.clear();
    for (std::size_t i = memory_.slots.size(); i > used; --i) {
      const LocalIndex slot = memory_.slots[i - 1];
      --count;
      if (slot == count)
        continue;
      move(count, slot);
      if (near == count)
        near = slot;
    }
    mesh_.corners.resize(3 * position(count));
    mesh_.neighbours.resize(3 * position(count));
    return near;
  }

  LocalIndex triangle_beyond() const {
    const auto some = std::ranges::find_if(memory_.beyond, [](HalfEdge h) { return h != none; });
    return some != memory_.beyond.end() ? triangle_of(*some) : none;
  }

  void move(LocalIndex from, LocalIndex to) {
    for (int side = 0; side < 3; ++side) {
      const HalfEdge beyond = twin(mesh_, half_edge(from, side));
      mesh_.corners[position(half_edge(to, side))] = mesh_.corners[position(half_edge(from, side))];
      mesh_.neighbours[position(half_edge(to, side))] = mesh_.neighbours[position(half_edge(from, side))];
      if (beyond != none)
        mesh_.neighbours[position(beyond)] = to;
    }
    memory_.triangles_moved.insert(memory_.triangles_moved.end(), {from, to});
  }

  std::span<const Point> sites_;
  Triangulation &mesh_;
  RemovalMemory &memory_;
};

} // namespace

Removal remove(std::vector<Point> &sites, Triangulation &mesh, LocalIndex vertex, LocalIndex hint,
               RemovalMemory &memory) {
  LocalIndex near = none;
  if (mesh.triangle_count() > 0)
    near = Hollow(sites, mesh, memory).empty_and_fill(link_edge(sites, mesh, vertex, hint));
  const auto last = static_cast<LocalIndex>(sites.size() - 1);
  if (mesh.triangle_count() > 0 && vertex != last) {
    find_star(mesh, link_edge(sites, mesh, last, near), memory.star);
    for (const HalfEdge edge : memory.star.link)
      mesh.corners[position(edge)] = vertex;
  }
  sites[position(vertex)] = sites.back();
  sites.pop_back();
  return {near, vertex != last ? last : none};
}

std::vector<LocalIndex> remove_batch(std::vector<Point> &sites, Triangulation &mesh,
                                     std::span<const LocalIndex> vertices) {
  std::vector<Point> removed;
  for (const LocalIndex vertex : vertices)
    removed.push_back(sites[position(vertex)]);
  std::vector<LocalIndex> number(sites.size(), 0);
  RemovalMemory memory;
  LocalIndex near = none;
  for (const LocalIndex i : space_filling_order(removed)) {
    const LocalIndex vertex = vertices[position(i)];
    number[position(vertex)] = none;
    if (mesh.triangle_count() > 0)
      near = Hollow(sites, mesh, memory).empty_and_fill(link_edge(sites, mesh, vertex, near));
  }
  LocalIndex kept = 0;
  for (std::size_t v = 0; v < sites.size(); ++v)
    if (number[v] != none) {
      sites[position(kept)] = sites[v];
      number[v] = kept++;
    }
  sites.resize(position(kept));
  for (LocalIndex &corner : mesh.corners)
    corner = number[position(corner)];
  return number;
}

} // namespace dovetail
