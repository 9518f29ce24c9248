#include "dovetail/mesh/insert.hpp"

#include "dovetail/base/error.hpp"
#include "dovetail/base/huge_pages.hpp"
#include "dovetail/mesh/divide_and_conquer.hpp"
#include "dovetail/mesh/space_filling_order.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace dovetail {
namespace {

/// The first triangles: all sites but the last are collinear.
void fan(std::span<const Point> sites, Triangulation &mesh) {
  const auto tip = static_cast<LocalIndex>(sites.size() - 1);
  std::vector<LocalIndex> line(position(tip));
  std::iota(line.begin(), line.end(), 0);
  std::ranges::sort(line, lexicographically_less, [&](LocalIndex v) { return sites[position(v)]; });
  if (orientation(sites[position(line.front())], sites[position(line.back())], sites.back()) ==
      Sign::negative)
    std::ranges::reverse(line);
  for (LocalIndex t = 0; t + 1 < tip; ++t) {
    mesh.corners.insert(mesh.corners.end(), {tip, line[position(t)], line[position(t + 1)]});
    mesh.neighbours.insert(mesh.neighbours.end(), {none, t + 2 < tip ? t + 1 : none, t - 1});
  }
}

/// A site that equals no other, while there are no triangles: all sites are collinear.
void add_without_triangles(std::vector<Point> &sites, Triangulation &mesh, Point site) {
  if (sites.size() >= most_delaunay_sites)
    throw Error({ErrorKind::resource, "triangulation", "",
                 "a mesh grows beyond what 32-bit indices can number", "use more slabs"});
  sites.push_back(site);
  if (sites.size() >= 3 && orientation(sites[0], sites[1], site) != Sign::zero)
    fan(sites, mesh);
}

Insertion insert_at(std::vector<Point> &sites, Triangulation &mesh, Point site, const Place &place,
                    Cavity &memory) {
  if (place.kind == PlaceKind::vertex)
    return {mesh.corners[position(half_edge(place.triangle, place.side))], place.triangle, false};
  find_cavity(sites, mesh, site, place, memory);
  const auto vertex = static_cast<LocalIndex>(sites.size());
  const LocalIndex first_new = commit(mesh, memory, vertex); // checks that there is room
  sites.push_back(site);
  return {vertex, star_triangle(memory, first_new, 0), true};
}

/// The edge of the boundary of a cavity that is in the direction of another point, as seen from its site; any
/// if the site is on the border. Rounded, and good for a guess. Any edge is as likely: no branch on it.
std::size_t edge_towards(std::span<const Point> sites, const Cavity &cavity, Point site, Point point) {
  const double dx = point.x - site.x, dy = point.y - site.y;
  const auto is_left = [&](LocalIndex vertex) {
    const Point end = sites[position(vertex)];
    return static_cast<std::size_t>(dx * (end.y - site.y) > dy * (end.x - site.x));
  };
  std::size_t towards = 0, from_is_left = is_left(cavity.edges.front().from);
  for (std::size_t e = 0; e < cavity.edges.size(); ++e) {
    const std::size_t to_is_left = is_left(cavity.edges[e].to);
    towards ^= (towards ^ e) & (0 - (to_is_left & (1 - from_is_left)));
    from_is_left = to_is_left;
  }
  return towards;
}

/// The order jumps about in what is by point: so many insertions ahead it is asked for.
constexpr std::ptrdiff_t points_ahead = 8;

/// Points number order[0], order[1], ...
std::vector<LocalIndex> insert_ordered(std::vector<Point> &sites, Triangulation &mesh,
                                       std::span<const Point> points, std::span<const LocalIndex> order) {
  const std::size_t most = sites.size() + points.size();
  const auto reserve = [](auto &values, std::size_t count) { // small batches must not copy the mesh each time
    if (count > values.capacity())
      reserve_huge(values, std::max(count, values.capacity() + values.capacity() / 2));
  };
  reserve(sites, most);
  reserve(mesh.corners, 6 * most);
  reserve(mesh.neighbours, 6 * most);
  std::vector<LocalIndex> vertex_of_point(points.size());
  auto next = order.begin();
  if (mesh.triangle_count() == 0) {
    std::map<Point, LocalIndex, decltype(&lexicographically_less)> on_line(lexicographically_less);
    for (const Point &site : sites)
      on_line.emplace(site, static_cast<LocalIndex>(on_line.size()));
    for (; next != order.end() && mesh.triangle_count() == 0; ++next) {
      const Point site = points[position(*next)];
      const auto [known, is_new] = on_line.emplace(site, static_cast<LocalIndex>(sites.size()));
      vertex_of_point[position(*next)] = known->second;
      if (is_new)
        add_without_triangles(sites, mesh, site);
    }
  }
  Cavity memory;
  LocalIndex hint = none;
  for (; next != order.end(); ++next) {
    if (order.end() - next > points_ahead) {
      const std::size_t soon = position(next[points_ahead]);
      __builtin_prefetch(&points[soon]);
      __builtin_prefetch(&vertex_of_point[soon], 1);
    }
    const LocalIndex first_new = mesh.triangle_count();
    const Point site = points[position(*next)];
    const Insertion done = insert(sites, mesh, site, hint, memory);
    vertex_of_point[position(*next)] = done.vertex;
    hint = done.triangle;
    if (done.is_new && next + 1 != order.end())
      hint = star_triangle(memory, first_new, edge_towards(sites, memory, site, points[position(next[1])]));
  }
  return vertex_of_point;
}

} // namespace

LocalIndex jump(std::span<const Point> sites, const Triangulation &mesh, Point point) {
  const LocalIndex count = mesh.triangle_count();
  const auto samples = static_cast<LocalIndex>(std::cbrt(count)) + 1;
  LocalIndex best = 0;
  double least = INFINITY;
  for (LocalIndex i = 0; i < samples; ++i) {
    const auto t = static_cast<LocalIndex>(GlobalIndex{count} * i / samples);
    const Point corner = sites[position(mesh.corners[position(half_edge(t, 0))])];
    const double dx = corner.x - point.x, dy = corner.y - point.y;
    if (const double distance = dx * dx + dy * dy; distance < least) {
      least = distance;
      best = t;
    }
  }
  return best;
}

Insertion insert(std::vector<Point> &sites, Triangulation &mesh, Point site, LocalIndex hint,
                 Cavity &memory) {
  if (mesh.triangle_count() == 0) {
    const auto vertex = static_cast<LocalIndex>(std::ranges::find(sites, site) - sites.begin());
    const bool is_new = position(vertex) == sites.size();
    if (is_new)
      add_without_triangles(sites, mesh, site);
    return {vertex, mesh.triangle_count() > 0 ? 0 : none, is_new};
  }
  if (hint == none)
    hint = jump(sites, mesh, site);
  return insert_at(sites, mesh, site, locate(sites, mesh, site, hint), memory);
}

std::vector<LocalIndex> insert_in_order(std::vector<Point> &sites, Triangulation &mesh,
                                        std::span<const Point> points) {
  std::vector<LocalIndex> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  return insert_ordered(sites, mesh, points, order);
}

std::vector<LocalIndex> insert_batch(std::vector<Point> &sites, Triangulation &mesh,
                                     std::span<const Point> points) {
  return insert_ordered(sites, mesh, points, space_filling_order(points));
}

} // namespace dovetail
