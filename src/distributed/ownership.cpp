#include "dovetail/distributed/ownership.hpp"

#include <algorithm>
#include <cassert>

namespace dovetail {
namespace {

/// The slab that `number` falls into. Slabs without any share their offset with the next one.
int slab_of(const std::vector<GlobalIndex> &offsets, GlobalIndex number) {
  assert(number >= 0 && number < offsets.back());
  return static_cast<int>(std::ranges::upper_bound(offsets, number) - offsets.begin()) - 1;
}

} // namespace

int slab_of_site(const DistributedMesh &mesh, GlobalIndex site) { return slab_of(mesh.site_offsets, site); }

int slab_of_triangle(const DistributedMesh &mesh, GlobalIndex triangle) {
  return slab_of(mesh.triangle_offsets, triangle);
}

int rank_of_site(const DistributedMesh &mesh, GlobalIndex site, int ranks) {
  return rank_of_slab(mesh.slab_count(), slab_of_site(mesh, site), ranks);
}

int rank_of_triangle(const DistributedMesh &mesh, GlobalIndex triangle, int ranks) {
  return rank_of_slab(mesh.slab_count(), slab_of_triangle(mesh, triangle), ranks);
}

GlobalIndex number_of_vertex(const SlabMesh &slab, LocalIndex vertex) {
  return vertex < slab.own_count ? slab.first_site + vertex
                                 : slab.ghost_number[static_cast<std::size_t>(vertex - slab.own_count)];
}

GlobalIndex number_of_neighbour(const SlabMesh &slab, LocalIndex side) {
  const LocalIndex inside = slab.triangles.neighbours[static_cast<std::size_t>(side)];
  if (inside != none)
    return slab.first_triangle + inside;
  const auto found = std::ranges::lower_bound(slab.border_sides, side, {}, &BorderSide::side);
  return found != slab.border_sides.end() && found->side == side ? found->neighbour : GlobalIndex{none};
}

std::vector<int> neighbour_ranks(const DistributedMesh &mesh, int rank, int ranks) {
  std::vector<bool> met(static_cast<std::size_t>(ranks));
  for (const SlabMesh &slab : mesh.slabs)
    for (const BorderSide &side : slab.border_sides)
      met[static_cast<std::size_t>(rank_of_triangle(mesh, side.neighbour, ranks))] = true;
  std::vector<int> result;
  for (int other = 0; other < ranks; ++other)
    if (other != rank && met[static_cast<std::size_t>(other)])
      result.push_back(other);
  return result;
}

} // namespace dovetail
