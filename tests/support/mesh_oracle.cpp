#include "support/mesh_oracle.hpp"

#include "dovetail/geometry/predicates.hpp"
#include "dovetail/mesh/checksum.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <random>
#include <set>

namespace dovetail::oracle {
namespace {

template <class T> std::size_t at(T index) { return static_cast<std::size_t>(index); }

using Corners = std::array<LocalIndex, 3>;
using Edge = std::pair<LocalIndex, LocalIndex>;

/// A hull edge with everything on its left: from the lexicographically smallest site to the one that leaves
/// no site on the right, the nearest of those in line.
Edge first_hull_edge(const std::vector<Point> &sites) {
  const auto low = static_cast<LocalIndex>(
      std::min_element(sites.begin(), sites.end(), lexicographically_less) - sites.begin());
  LocalIndex best = none;
  for (LocalIndex c = 0; c < static_cast<LocalIndex>(sites.size()); ++c) {
    if (c == low)
      continue;
    if (best == none) {
      best = c;
      continue;
    }
    const Sign turn = exact::orientation(sites[at(low)], sites[at(best)], sites[at(c)]);
    if (turn == Sign::negative ||
        (turn == Sign::zero && lexicographically_less(sites[at(c)], sites[at(best)])))
      best = c;
  }
  return {low, best};
}

/// The site that makes a Delaunay triangle on the left of an edge.
LocalIndex apex(const std::vector<Point> &sites, Edge edge) {
  const Point a = sites[at(edge.first)];
  const Point b = sites[at(edge.second)];
  LocalIndex best = none;
  for (LocalIndex c = 0; c < static_cast<LocalIndex>(sites.size()); ++c) {
    if (exact::orientation(a, b, sites[at(c)]) != Sign::positive)
      continue;
    if (best == none || exact::in_circle(a, b, sites[at(best)], sites[at(c)]) == Sign::positive)
      best = c;
  }
  return best;
}

std::vector<Point> ascending_path(const std::vector<Point> &sites, SplitLine line) {
  const auto above = [&](Point p) { return along(p, line.axis); };
  std::vector<Point> order = sites;
  std::sort(order.begin(), order.end(), [&](Point a, Point b) {
    if (above(a) != above(b))
      return above(a) < above(b);
    // Nearer to the line first; exactly as near, the one beyond it. The families here have small integers or
    // random coordinates, for which these differences are right.
    const double da = std::abs(across(a, line.axis) - line.position);
    const double db = std::abs(across(b, line.axis) - line.position);
    return da != db ? da < db : across(a, line.axis) > across(b, line.axis);
  });
  order.erase(std::unique(order.begin(), order.end(), [&](Point a, Point b) { return above(a) == above(b); }),
              order.end());
  std::vector<Point> hull;
  for (const Point p : order) {
    while (hull.size() >= 2 &&
           exact::hull_turn(hull[hull.size() - 2], hull.back(), p, line) == Sign::negative)
      hull.pop_back();
    hull.push_back(p);
  }
  return hull;
}

/// Everything about a mesh in one place: sites by global number.
struct Whole {
  PointTable sites;
  std::vector<Duplicate> duplicates;
  InputDigest digest;
  std::vector<GlobalIndex> site_offsets;
  std::vector<double> lines;
  std::vector<std::vector<Corners>> slab_triangles; ///< site numbers
  std::vector<GlobalIndex> triangle_offsets{0};
  std::map<Edge, GlobalIndex> triangle_of_edge;
};

void sort_points(const PointTable &points, Axis axis, Whole &whole) {
  const TotalOrder less{axis};
  std::vector<std::size_t> order(points.points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (points.points[a] != points.points[b])
      return less(points.points[a], points.points[b]);
    return points.input_index[a] < points.input_index[b];
  });
  for (const Attribute &attribute : points.attributes)
    whole.sites.attributes.push_back({attribute.name, {}});
  for (const std::size_t p : order) {
    const double z = points.attributes.empty() ? 0.0 : points.attributes.front().values[p];
    whole.digest.hash += digest_of_point(points.points[p], z, points.input_index[p]);
    ++whole.digest.points;
    if (!whole.sites.points.empty() && whole.sites.points.back() == points.points[p]) {
      const auto site = static_cast<GlobalIndex>(whole.sites.points.size()) - 1;
      whole.duplicates.push_back({points.input_index[p], site, z});
      continue;
    }
    whole.sites.points.push_back(points.points[p]);
    whole.sites.input_index.push_back(points.input_index[p]);
    for (std::size_t a = 0; a < points.attributes.size(); ++a)
      whole.sites.attributes[a].values.push_back(points.attributes[a].values[p]);
  }
}

void cut(int slabs, Axis axis, Whole &whole) {
  const auto count = static_cast<GlobalIndex>(whole.sites.points.size());
  for (int s = 0; s <= slabs; ++s)
    whole.site_offsets.push_back(count * s / slabs);
  for (int s = 1; s < slabs; ++s) {
    const GlobalIndex before = std::max<GlobalIndex>(whole.site_offsets[at(s)] - 1, 0);
    whole.lines.push_back(count == 0 ? 0.0 : across(whole.sites.points[at(before)], axis));
  }
}

void deal_triangles(const std::vector<Corners> &triangles_of_whole, Axis axis, Whole &whole) {
  const std::vector<Point> &sites = whole.sites.points;
  whole.slab_triangles.resize(whole.lines.size() + 1);
  for (const Corners &t : triangles_of_whole) {
    std::size_t slab = 0;
    while (slab < whole.lines.size() &&
           !exact::circumcenter_is_left(sites[at(t[0])], sites[at(t[1])], sites[at(t[2])],
                                        {whole.lines[slab], axis}))
      ++slab;
    whole.slab_triangles[slab].push_back(t);
  }
  GlobalIndex number = 0;
  for (auto &triangles : whole.slab_triangles) {
    std::sort(triangles.begin(), triangles.end());
    for (const Corners &t : triangles) {
      for (std::size_t i = 0; i < 3; ++i)
        whole.triangle_of_edge[{t[(i + 1) % 3], t[(i + 2) % 3]}] = number;
      ++number;
    }
    whole.triangle_offsets.push_back(number);
  }
}

SlabMesh make_slab(int s, Axis axis, const Whole &whole) {
  SlabMesh slab;
  slab.first_site = whole.site_offsets[at(s)];
  slab.own_count = static_cast<LocalIndex>(whole.site_offsets[at(s) + 1] - slab.first_site);
  slab.first_triangle = whole.triangle_offsets[at(s)];
  const GlobalIndex end_site = slab.first_site + slab.own_count;
  std::vector<GlobalIndex> numbers(at(slab.own_count));
  std::iota(numbers.begin(), numbers.end(), slab.first_site);
  std::set<GlobalIndex> ghosts;
  for (const Corners &t : whole.slab_triangles[at(s)])
    for (const LocalIndex v : t)
      if (v < slab.first_site || v >= end_site)
        ghosts.insert(v);
  slab.ghost_number.assign(ghosts.begin(), ghosts.end());
  numbers.insert(numbers.end(), ghosts.begin(), ghosts.end());
  std::map<GlobalIndex, LocalIndex> local;
  for (const Attribute &attribute : whole.sites.attributes)
    slab.vertices.attributes.push_back({attribute.name, {}});
  for (const GlobalIndex v : numbers) {
    local[v] = static_cast<LocalIndex>(slab.vertices.points.size());
    slab.vertices.points.push_back(whole.sites.points[at(v)]);
    slab.vertices.input_index.push_back(whole.sites.input_index[at(v)]);
    for (std::size_t a = 0; a < whole.sites.attributes.size(); ++a)
      slab.vertices.attributes[a].values.push_back(whole.sites.attributes[a].values[at(v)]);
  }
  const GlobalIndex end_triangle = whole.triangle_offsets[at(s) + 1];
  for (const Corners &t : whole.slab_triangles[at(s)])
    for (std::size_t i = 0; i < 3; ++i) {
      slab.triangles.corners.push_back(local.at(t[i]));
      const auto twin = whole.triangle_of_edge.find({t[(i + 2) % 3], t[(i + 1) % 3]});
      LocalIndex neighbour = none;
      if (twin != whole.triangle_of_edge.end()) {
        if (twin->second >= slab.first_triangle && twin->second < end_triangle)
          neighbour = static_cast<LocalIndex>(twin->second - slab.first_triangle);
        else
          slab.border_sides.push_back(
              {static_cast<LocalIndex>(slab.triangles.neighbours.size()), twin->second});
      }
      slab.triangles.neighbours.push_back(neighbour);
    }
  if (s > 0) {
    const std::vector<Point> &sites = whole.sites.points;
    for (const Point p : ascending_path(sites, {whole.lines[at(s) - 1], axis}))
      slab.left_path.push_back(std::lower_bound(sites.begin(), sites.end(), p, TotalOrder{axis}) -
                               sites.begin());
  }
  return slab;
}

} // namespace

std::vector<Corners> wrap(const std::vector<Point> &sites) {
  std::vector<Corners> triangles;
  if (sites.size() < 3)
    return triangles;
  std::set<Edge> open{first_hull_edge(sites)};
  std::set<Edge> done;
  while (!open.empty()) {
    const Edge edge = *open.begin();
    open.erase(open.begin());
    if (!done.insert(edge).second)
      continue;
    const LocalIndex c = apex(sites, edge);
    if (c == none)
      continue; // nothing beyond the hull
    triangles.push_back({edge.first, edge.second, c});
    for (const Edge &side : {Edge{edge.second, c}, Edge{c, edge.first}}) {
      done.insert(side);
      open.erase(side);
    }
    for (const Edge &beyond : {Edge{edge.second, edge.first}, Edge{c, edge.second}, Edge{edge.first, c}})
      if (!done.contains(beyond))
        open.insert(beyond);
  }
  return triangles;
}

std::vector<Point> sites_of(const PointTable &points, Axis axis) {
  std::vector<Point> sites = points.points;
  std::sort(sites.begin(), sites.end(), TotalOrder{axis});
  sites.erase(std::unique(sites.begin(), sites.end()), sites.end());
  return sites;
}

DistributedMesh make_mesh(const PointTable &points, const MeshRequest &request) {
  return make_mesh_of(points, wrap(sites_of(points, request.axis)), request);
}

DistributedMesh make_mesh_of(const PointTable &points, const std::vector<Corners> &triangles_of_whole,
                             const MeshRequest &request) {
  Whole whole;
  sort_points(points, request.axis, whole);
  cut(request.slabs, request.axis, whole);
  deal_triangles(triangles_of_whole, request.axis, whole);

  DistributedMesh mesh;
  mesh.axis = request.axis;
  mesh.site_offsets = whole.site_offsets;
  mesh.triangle_offsets = whole.triangle_offsets;
  mesh.lines = whole.lines;
  mesh.digest = whole.digest;
  mesh.checksum = checksum_of_sites(whole.sites.points);
  for (const auto &triangles : whole.slab_triangles)
    for (const Corners &t : triangles) {
      mesh.checksum += checksum_of_triangles(whole.sites.points, t);
      for (std::size_t i = 0; i < 3; ++i)
        mesh.hull_edges += !whole.triangle_of_edge.contains({t[(i + 2) % 3], t[(i + 1) % 3]});
    }
  mesh.first_slab = first_slab_of_rank(request.slabs, request.rank, request.ranks);
  const int end = first_slab_of_rank(request.slabs, request.rank + 1, request.ranks);
  for (int s = mesh.first_slab; s < end; ++s)
    mesh.slabs.push_back(make_slab(s, request.axis, whole));
  for (const Duplicate &entry : whole.duplicates)
    if (entry.site >= whole.site_offsets[at(mesh.first_slab)] && entry.site < whole.site_offsets[at(end)])
      mesh.duplicates.push_back(entry);
  return mesh;
}

PointTable table_of(const std::vector<Point> &points) {
  PointTable table;
  table.points = points;
  table.attributes = {{"z", {}}, {"intensity", {}}};
  for (std::size_t p = 0; p < points.size(); ++p) {
    table.input_index.push_back(static_cast<GlobalIndex>(p));
    table.attributes[0].values.push_back(0.25 * static_cast<double>(p % 97) - 3);
    table.attributes[1].values.push_back(static_cast<double>(p * p % 1009));
  }
  return table;
}

std::vector<Point> random_points(int count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::vector<Point> points(at(count));
  for (Point &p : points)
    p = {static_cast<double>(random() >> 11) * 0x1p-53, static_cast<double>(random() >> 11) * 0x1p-53};
  return points;
}

std::vector<Point> lattice_points(int count, int side, unsigned seed) {
  std::mt19937_64 random(seed);
  std::vector<Point> points(at(count));
  for (Point &p : points)
    p = {static_cast<double>(random() % static_cast<unsigned>(side)),
         static_cast<double>(random() % static_cast<unsigned>(side))};
  return points;
}

} // namespace dovetail::oracle
