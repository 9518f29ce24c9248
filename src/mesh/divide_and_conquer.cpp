#include "dovetail/mesh/divide_and_conquer.hpp"

#include "bucket.hpp"
#include "dovetail/base/error.hpp"
#include "dovetail/base/huge_pages.hpp"
#include "median_tree.hpp"
#include "merge.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace dovetail {
namespace {

using namespace divide_and_conquer;

constexpr LocalIndex far_ghost = none;
constexpr LocalIndex beyond = none; ///< twin of a hull edge once the ghosts are gone
constexpr std::size_t bucket_sites = 12288;

/// The sites of the whole where they are in the input.
struct FarSites {
  const Point *sites;
  Point operator[](Vertex v) const { return v == far_ghost ? far_away : sites[v]; }
};

/// Merges the leaves of the first cuts.
struct Conquest {
  const MedianTree &tree;
  const std::vector<LocalIndex> &start;
  BucketKernel &buckets;
  Sphere<FarSites> sphere;
  Triangulation &mesh;

  /// A vector sets to zero what it grows by. Growing by a bucket, within room that is reserved, leaves it in
  /// the cache for what is written next. (The corners are all there: the sites wait in them.)
  Hull triangulate(Vertex first, Vertex count) const {
    const auto end = static_cast<std::size_t>(6 * (first + count) - 6);
    mesh.neighbours.resize(std::max(mesh.neighbours.size(), end));
    return buckets.triangulate(first, count, far_ghost);
  }

  /// The part of a branch or leaf, whose leaves begin with `leaf` and number `leaves`; at least two
  /// sites.
  Hull conquer(std::size_t branch, std::size_t leaf, std::size_t leaves) const {
    const Vertex first = start[leaf];
    const Vertex count = start[leaf + leaves] - first;
    if (leaves == 1)
      return triangulate(first, count);
    const std::size_t middle = leaf + leaves / 2;
    const Vertex left_count = start[middle] - first;
    if (left_count == 0)
      return conquer(2 * branch + 1, middle, leaves / 2);
    if (left_count == count)
      return conquer(2 * branch, leaf, leaves / 2);
    if (left_count == 1 || left_count == count - 1)
      return triangulate(first, count);
    const Hull left = conquer(2 * branch, leaf, leaves / 2);
    const Hull right = conquer(2 * branch + 1, middle, leaves / 2);
    return sphere.merge(left, right, tree.axis(branch), 6 * (first + left_count) - 6);
  }
};

/// Drops the ghosts by moving triangles from the end into their places. Returns how many triangles stay.
LocalIndex drop_ghosts(const Sphere<FarSites> &sphere, HalfEdge ghost, LocalIndex triangles) {
  std::vector<LocalIndex> ghosts;
  const HalfEdge begin = ghost;
  do {
    ghosts.push_back(narrow(ghost / 3));
    ghost = sphere.ghost_after(ghost);
  } while (ghost != begin);
  std::ranges::sort(ghosts);
  for (const LocalIndex t : ghosts)
    if (sphere.twin[3 * t] != beyond)
      sphere.twin[sphere.twin[3 * t]] = beyond;
  const LocalIndex kept = triangles - static_cast<LocalIndex>(ghosts.size());
  auto last = ghosts.rbegin(); // the greatest ghost not yet met from the end
  LocalIndex from = triangles - 1;
  for (const LocalIndex hole : ghosts) {
    if (hole >= kept)
      break;
    for (; *last == from; ++last)
      --from;
    for (LocalIndex i = 0; i < 3; ++i) {
      const LocalIndex other = sphere.twin[3 * from + i];
      sphere.corner[3 * hole + i] = sphere.corner[3 * from + i];
      sphere.twin[3 * hole + i] = other;
      if (other != beyond)
        sphere.twin[other] = 3 * hole + i;
    }
    --from;
  }
  return kept;
}

/// From half-edges to the neighbours of a Triangulation, in place.
void number_neighbours(Triangulation &mesh) {
  for (LocalIndex &twin : mesh.neighbours) // `beyond` stays `none`, without a branch
    twin = static_cast<LocalIndex>(static_cast<std::uint32_t>(twin) / 3) | (twin >> 31);
}

/// The greatest power of two of which all coordinates are multiples, or zero if it is too small to be of use:
/// then a look at few sites is enough to tell. `reach` is the greatest coordinate.
double common_unit(std::span<const Point> sites, double reach) {
  constexpr double longest = 0x1p40; // in units
  constexpr double to_integer = 0x1.8p52;
  constexpr double least = 0x1p-200;
  if (!(reach >= least))
    return 0;
  double unit = std::exp2(std::ilogb(reach));
  for (const Point &p : sites)
    for (;;) {
      const Pair at{p.x, p.y};
      const Pair back = ((at * (1 / unit) + to_integer) - to_integer) * unit; // unless the product underflows
      if ((back[0] == at[0]) & (back[1] == at[1])) [[likely]]
        break;
      unit /= 2;
      if (unit < least || reach / unit > longest)
        return 0;
    }
  return unit;
}

Filter filter_for(std::span<const Point> sites) {
  Box box(sites.front());
  for (const Point &p : sites)
    box.add(p);
  const Pair least = -box.low;
  const double reach = std::max({box.high[0], box.high[1], least[0], least[1]});
  if (!(reach <= greatest_filtered_coordinate))
    return {};
  Filter filter;
  filter.guard = sight_guard;
  if (const double unit = common_unit(sites, reach); unit > 0) {
    const Pair size = box.high - box.low;
    filter.exact_z = exact_circle_z * unit * unit;
    filter.turns_are_exact = size[0] * size[0] + size[1] * size[1] <= exact_turn_z * unit * unit;
  }
  return filter;
}

} // namespace

Triangulation delaunay(std::span<const Point> sites) {
  if (sites.size() > most_delaunay_sites)
    throw Error({ErrorKind::resource, "triangulation", "",
                 "a slab has more sites than 32-bit indices can number", "use more slabs"});
  if (sites.size() < 3)
    return {};
  const std::size_t n = sites.size();
  Triangulation mesh;
  reserve_huge(mesh.corners, 6 * n);
  reserve_huge(mesh.neighbours, 6 * n);
  mesh.corners.resize(6 * n);
  mesh.neighbours.resize(n);
  const MedianTree tree = median_tree(sites, static_cast<unsigned>(std::bit_width(n / bucket_sites)));
  const std::vector<LocalIndex> start = sort_into_leaves(tree, sites, mesh.corners, mesh.neighbours);
  const Filter filter = filter_for(sites);
  BucketKernel buckets(mesh.corners.data(), mesh.neighbours.data(), filter);
  const Sphere<FarSites> sphere{
      {sites.data()}, mesh.corners.data(), mesh.neighbours.data(), far_ghost, filter};
  const Hull hull = Conquest{tree, start, buckets, sphere, mesh}.conquer(1, 0, tree.leaves());
  const LocalIndex triangles = drop_ghosts(sphere, hull.first[0], static_cast<LocalIndex>(2 * n - 2));
  mesh.corners.resize(3 * static_cast<std::size_t>(triangles));
  mesh.neighbours.resize(3 * static_cast<std::size_t>(triangles));
  number_neighbours(mesh);
  return mesh;
}

} // namespace dovetail
