// Sites against their ghosts, their use, and the sums that a mesh keeps of them.
#include "validation.hpp"

#include "dovetail/mesh/checksum.hpp"

#include <fmt/format.h>

#include <bit>

namespace dovetail::validation {
namespace {

/// A ghost, told to the owner of its site.
struct GhostNotice {
  GlobalIndex number;
  Point point;
  GlobalIndex input_index;
  std::uint64_t attributes; ///< hash of their bits
  std::int64_t slab;        ///< that has the ghost
};

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

/// Marks the own sites of every slab that its triangles use, and tells of its ghosts.
std::vector<GhostNotice> ghost_notices(const DistributedMesh &mesh, std::vector<std::vector<bool>> &used,
                                       Findings &findings) {
  std::vector<GhostNotice> told;
  int s = mesh.first_slab;
  for (const SlabMesh &slab : mesh.slabs) {
    used.push_back(used_vertices(slab));
    for (std::size_t g = 0; g < slab.ghost_number.size(); ++g) {
      const std::size_t v = at(slab.own_count) + g;
      if (used.back()[v])
        told.push_back({slab.ghost_number[g], slab.vertices.points[v], slab.vertices.input_index[v],
                        hash_of_attributes(slab.vertices, v), s});
      else
        findings.add(ViolationKind::unused_site, [&] {
          return fmt::format("slab {}: its ghost of site {} is in none of its triangles", s,
                             slab.ghost_number[g]);
        });
    }
    used.back().resize(at(slab.own_count));
    ++s;
  }
  return told;
}

} // namespace

void check_ghosts_and_use(const Communicator &comm, const DistributedMesh &mesh, const Ownership &owners,
                          Findings &findings) {
  std::vector<std::vector<bool>> used;
  const auto notices = deliver(
      comm, [&] { return ghost_notices(mesh, used, findings); },
      [&](const GhostNotice &ghost) { return owners.rank_of_site(ghost.number); });
  for (const GhostNotice &ghost : notices) {
    const std::size_t k = at(owners.slab_of_site(ghost.number) - mesh.first_slab);
    check_ghost(mesh.slabs[k], ghost, findings);
    used[k][at(ghost.number - mesh.slabs[k].first_site)] = true;
  }
  for (std::size_t k = 0; k < mesh.slabs.size(); ++k)
    for (std::size_t v = 0; v < used[k].size(); ++v)
      if (!used[k][v])
        findings.add(ViolationKind::unused_site, [&] {
          return fmt::format("site {} {} is in no triangle",
                             mesh.slabs[k].first_site + static_cast<GlobalIndex>(v),
                             text_of(mesh.slabs[k].vertices.points[v]));
        });
}

void check_checksum(const Communicator &comm, const DistributedMesh &mesh, Findings &findings) {
  std::uint64_t sum = 0;
  for (const SlabMesh &slab : mesh.slabs) {
    const std::span<const Point> vertices = slab.vertices.points;
    sum += checksum_of_sites(vertices.first(at(slab.own_count)));
    sum += checksum_of_triangles(vertices, slab.triangles.corners);
  }
  findings.counts.checksum = all_reduce_sum(comm, sum);
  if (findings.counts.checksum != mesh.checksum && comm.is_root())
    findings.add(ViolationKind::checksum, [&] {
      return fmt::format("the mesh says {}, and its sites and triangles have {}",
                         checksum_text(mesh.checksum), checksum_text(findings.counts.checksum));
    });
}

namespace {

const SlabMesh *slab_that_owns(const DistributedMesh &mesh, GlobalIndex site) {
  for (const SlabMesh &slab : mesh.slabs)
    if (site >= slab.first_site && site < slab.first_site + slab.own_count)
      return &slab;
  return nullptr;
}

/// Local: the digest of own sites and duplicates.
InputDigest digest_of(const DistributedMesh &mesh, Findings &findings) {
  InputDigest digest;
  for (const SlabMesh &slab : mesh.slabs) {
    const std::vector<double> *z = z_of(slab.vertices);
    for (std::size_t v = 0; v < at(slab.own_count); ++v)
      digest.hash +=
          digest_of_point(slab.vertices.points[v], z ? (*z)[v] : 0.0, slab.vertices.input_index[v]);
    digest.points += slab.own_count;
  }
  const SlabMesh *slab = nullptr;
  const Duplicate *before = nullptr;
  for (const Duplicate &entry : mesh.duplicates) {
    if (slab == nullptr || entry.site < slab->first_site || entry.site >= slab->first_site + slab->own_count)
      slab = slab_that_owns(mesh, entry.site);
    if (slab == nullptr) {
      findings.add(ViolationKind::duplicate, [&] {
        return fmt::format("input point {} equals site {}, which is none of its rank's", entry.input_index,
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
    digest.hash += digest_of_point(point_of(*slab, static_cast<LocalIndex>(entry.site - slab->first_site)),
                                   entry.z, entry.input_index);
    ++digest.points;
  }
  return digest;
}

} // namespace

void check_duplicates_and_digest(const Communicator &comm, const DistributedMesh &mesh, Findings &findings) {
  findings.counts.duplicates = static_cast<GlobalIndex>(mesh.duplicates.size());
  const InputDigest own = digest_of(mesh, findings);
  const InputDigest all{all_reduce_sum(comm, own.points), all_reduce_sum(comm, own.hash)};
  if ((all.points != mesh.digest.points || all.hash != mesh.digest.hash) && comm.is_root())
    findings.add(ViolationKind::digest, [&] {
      return fmt::format(
          "the mesh says it was made of {} points with digest {:016x}; its sites and duplicates "
          "are {} with digest {:016x}",
          mesh.digest.points, mesh.digest.hash, all.points, all.hash);
    });
}

} // namespace dovetail::validation
