// Sites against their ghosts, their use, and the sums that a mesh keeps of them.
#include "validation.hpp"

#include "dovetail/mesh/checksum.hpp"

#include <fmt/format.h>

#include <bit>

namespace dovetail::validation {
namespace {

std::uint64_t hash_of_attributes(const PointTable &table, std::size_t v) {
  std::uint64_t hash = 0;
  for (const Attribute &attribute : table.attributes) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(attribute.values[v])) * 0x94d049bb133111ebU;
    hash ^= hash >> 29;
  }
  return hash;
}

std::vector<bool> used_vertices(const SlabMesh &slab) {
  std::vector<bool> used(slab.vertices.points.size(), false);
  for (const LocalIndex v : slab.triangles.corners)
    used[at(v)] = true;
  return used;
}

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

void check_ghost(const SlabMesh &slab, const GhostNotice &ghost, Findings &findings) {
  const std::size_t v = at(ghost.number - slab.first_site);
  const Point p = slab.vertices.points[v];
  const char *difference = nullptr;
  if (!same_bits(p.x, ghost.point.x) || !same_bits(p.y, ghost.point.y))
    difference = "coordinates";
  else if (slab.vertices.input_index[v] != ghost.input_index)
    difference = "an input index";
  else if (hash_of_attributes(slab.vertices, v) != ghost.attributes)
    difference = "attributes";
  if (difference != nullptr)
    findings.add(ViolationKind::ghost, [&] {
      return fmt::format("slab {} has site {} as a ghost with other {}: {} for {}", ghost.slab, ghost.number,
                         difference, text_of(ghost.point), text_of(p));
    });
}

/// Local. Those with a number that no site has are left for gather_layout to complain of.
std::vector<GhostNotice> ghost_notices(SlabSource &source) {
  const DistributedMesh &common = source.common();
  std::vector<GhostNotice> told;
  for (int k = 0; k < source.own_slab_count(); ++k) {
    const SlabMesh ghosts = source.ghosts(k);
    const PointTable &table = ghosts.vertices;
    const auto is_short = [&](const auto &column) { return column.size() < ghosts.ghost_number.size(); };
    if (is_short(table.points) || is_short(table.input_index) ||
        std::ranges::any_of(table.attributes, [&](const Attribute &a) { return is_short(a.values); }))
      continue;
    for (std::size_t g = 0; g < ghosts.ghost_number.size(); ++g)
      if (const GlobalIndex number = ghosts.ghost_number[g]; number >= 0 && number < common.site_count())
        told.push_back({number, table.points[g], table.input_index[g], hash_of_attributes(table, g),
                        common.first_slab + k});
  }
  return told;
}

} // namespace

std::vector<GhostNotice> ghosts_of_own_sites(const Communicator &comm, SlabSource &source,
                                             const Ownership &owners) {
  auto ghosts = deliver(
      comm, [&] { return ghost_notices(source); },
      [&](const GhostNotice &ghost) { return owners.rank_of_site(ghost.number); });
  std::ranges::sort(ghosts, {}, &GhostNotice::number);
  return ghosts;
}

// A site without a triangle in its own slab is used where it is a ghost: a ghost that its slab does not use
// is complained of there.
void gather_sites(const SlabMesh &slab, int s, std::span<const GhostNotice> ghosts, Findings &findings) {
  std::vector<bool> used = used_vertices(slab);
  for (std::size_t g = 0; g < slab.ghost_number.size(); ++g)
    if (!used[at(slab.own_count) + g])
      findings.add(ViolationKind::unused_site, [&] {
        return fmt::format("slab {}: its ghost of site {} is in none of its triangles", s,
                           slab.ghost_number[g]);
      });
  const GlobalIndex end = slab.first_site + slab.own_count;
  for (auto ghost = std::ranges::lower_bound(ghosts, slab.first_site, {}, &GhostNotice::number);
       ghost != ghosts.end() && ghost->number < end; ++ghost) {
    check_ghost(slab, *ghost, findings);
    used[at(ghost->number - slab.first_site)] = true;
  }
  for (std::size_t v = 0; v < at(slab.own_count); ++v)
    if (!used[v])
      findings.add(ViolationKind::unused_site, [&] {
        return fmt::format("site {} {} is in no triangle", slab.first_site + static_cast<GlobalIndex>(v),
                           text_of(slab.vertices.points[v]));
      });
}

namespace {

InputDigest digest_of_sites(const SlabMesh &slab) {
  InputDigest digest{slab.own_count, 0};
  const std::vector<double> *z = z_of(slab.vertices);
  for (std::size_t v = 0; v < at(slab.own_count); ++v)
    digest.hash += digest_of_point(slab.vertices.points[v], z ? (*z)[v] : 0.0, slab.vertices.input_index[v]);
  return digest;
}

InputDigest digest_of_duplicates(const SlabMesh &slab, std::span<const Duplicate> duplicates,
                                 Findings &findings) {
  InputDigest digest;
  const Duplicate *before = nullptr;
  for (const Duplicate &entry : duplicates) {
    if (entry.site < slab.first_site || entry.site >= slab.first_site + slab.own_count) {
      findings.add(ViolationKind::duplicate, [&] {
        return fmt::format("input point {} equals site {}, which is none of its slab's", entry.input_index,
                           entry.site);
      });
      continue;
    }
    if (before != nullptr &&
        std::pair(before->site, before->input_index) >= std::pair(entry.site, entry.input_index))
      findings.add(ViolationKind::duplicate, [&] {
        return fmt::format("input point {}, equal to site {}, is out of order", entry.input_index,
                           entry.site);
      });
    before = &entry;
    digest.hash += digest_of_point(point_of(slab, static_cast<LocalIndex>(entry.site - slab.first_site)),
                                   entry.z, entry.input_index);
    ++digest.points;
  }
  return digest;
}

} // namespace

void gather_sums(const SlabMesh &slab, std::span<const Duplicate> duplicates, Gathered &gathered,
                 Findings &findings) {
  const std::span<const Point> vertices = slab.vertices.points;
  gathered.checksum += checksum_of_sites(vertices.first(at(slab.own_count)));
  gathered.checksum += checksum_of_triangles(vertices, slab.triangles.corners);
  for (const InputDigest &part : {digest_of_sites(slab), digest_of_duplicates(slab, duplicates, findings)}) {
    gathered.digest.points += part.points;
    gathered.digest.hash += part.hash;
  }
  findings.counts.duplicates += static_cast<GlobalIndex>(duplicates.size());
}

void check_sums(const Communicator &comm, const DistributedMesh &common, const Gathered &gathered,
                Findings &findings) {
  const std::uint64_t sum = all_reduce_sum(comm, gathered.checksum);
  findings.counts.checksum = sum;
  const InputDigest all{all_reduce_sum(comm, gathered.digest.points),
                        all_reduce_sum(comm, gathered.digest.hash)};
  if (!comm.is_root())
    return;
  if (sum != common.checksum)
    findings.add(ViolationKind::checksum, [&] {
      return fmt::format("the mesh says {}, and its sites and triangles have {}",
                         checksum_text(common.checksum), checksum_text(sum));
    });
  if (all.points != common.digest.points || all.hash != common.digest.hash)
    findings.add(ViolationKind::digest, [&] {
      return fmt::format(
          "the mesh says it was made of {} points with digest {:016x}; its sites and duplicates "
          "are {} with digest {:016x}",
          common.digest.points, common.digest.hash, all.points, all.hash);
    });
}

} // namespace dovetail::validation
