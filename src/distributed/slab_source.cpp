#include "dovetail/distributed/slab_source.hpp"

#include <algorithm>

namespace dovetail {

SlabMesh SlabsInMemory::ghosts(int k) {
  const SlabMesh &slab = mesh_.slabs[static_cast<std::size_t>(k)];
  const auto behind_own = [&](const auto &column) {
    const auto own = std::min<std::ptrdiff_t>(slab.own_count, std::ssize(column));
    return std::remove_cvref_t<decltype(column)>(column.begin() + own, column.end());
  };
  SlabMesh ghosts;
  ghosts.ghost_number = slab.ghost_number;
  ghosts.vertices.points = behind_own(slab.vertices.points);
  ghosts.vertices.input_index = behind_own(slab.vertices.input_index);
  for (const Attribute &attribute : slab.vertices.attributes)
    ghosts.vertices.attributes.push_back({attribute.name, behind_own(attribute.values)});
  return ghosts;
}

std::span<const Duplicate> SlabsInMemory::duplicates(int k) {
  // The first entry of a site at or beyond the end of a slab ends its part; the last slab has all the rest.
  const auto begin_of_part = [&](int part) {
    if (part == 0 || mesh_.slabs.empty())
      return mesh_.duplicates.begin();
    if (part == own_slab_count())
      return mesh_.duplicates.end();
    const GlobalIndex first_site = mesh_.slabs[static_cast<std::size_t>(part)].first_site;
    return std::ranges::find_if(mesh_.duplicates,
                                [&](const Duplicate &entry) { return entry.site >= first_site; });
  };
  return {begin_of_part(k), begin_of_part(k + 1)};
}

} // namespace dovetail
