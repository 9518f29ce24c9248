#include "dovetail/distributed/validate.hpp"

#include "validation.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/serialization.hpp"

#include <fmt/format.h>

namespace dovetail {
namespace validation {

void Findings::keep_only(std::initializer_list<ViolationKind> kinds) {
  const auto is_kept = [&](ViolationKind kind) { return std::ranges::find(kinds, kind) != kinds.end(); };
  for (std::size_t kind = 0; kind < violation_kinds; ++kind)
    if (!is_kept(static_cast<ViolationKind>(kind)))
      counts.violations_by_kind[kind] = 0;
  std::erase_if(counts.first_violations, [&](const Violation &found) { return !is_kept(found.kind); });
}

std::string text_of(Point p) { return fmt::format("({:.17g}, {:.17g})", p.x, p.y); }

std::string place_of(const SlabMesh &slab, int s, LocalIndex triangle) {
  const auto corner = [&](LocalIndex i) {
    return number_of(slab, slab.triangles.corners[at(3 * triangle + i)]);
  };
  return fmt::format("slab {}, triangle {} (sites {}, {}, {})", s, slab.first_triangle + triangle, corner(0),
                     corner(1), corner(2));
}

const std::vector<double> *z_of(const PointTable &table) {
  for (const Attribute &attribute : table.attributes)
    if (attribute.name == "z")
      return &attribute.values;
  return nullptr;
}

} // namespace validation

namespace {

using validation::at;
using validation::Findings;
using validation::Gathered;

/// Collective: the sums of all ranks' counts, and the first violations of every kind by rank.
ValidationReport combine(const Communicator &comm, const Findings &findings) {
  ValidationReport report = findings.counts;
  const auto fields = {
      &ValidationReport::sites,       &ValidationReport::ghosts,       &ValidationReport::triangles,
      &ValidationReport::inner_edges, &ValidationReport::border_edges, &ValidationReport::hull_edges,
      &ValidationReport::path_edges,  &ValidationReport::duplicates,   &ValidationReport::input_points};
  std::vector<GlobalIndex> values(report.violations_by_kind.begin(), report.violations_by_kind.end());
  for (const auto field : fields)
    values.push_back(report.*field);
  values = all_reduce_sum(comm, values);
  std::copy_n(values.begin(), violation_kinds, report.violations_by_kind.begin());
  auto value = values.begin() + violation_kinds;
  for (const auto field : fields)
    report.*field = *value++;
  report.violation_count =
      std::accumulate(report.violations_by_kind.begin(), report.violations_by_kind.end(), GlobalIndex{0});
  report.valid = report.violation_count == 0;

  std::vector<std::string> texts;
  for (std::size_t kind = 0; kind < violation_kinds; ++kind) {
    std::vector<std::string> own;
    for (const Violation &violation : findings.counts.first_violations)
      if (at(violation.kind) == kind)
        own.push_back(violation.text);
    if (report.violations_by_kind[kind] == 0)
      continue;
    std::vector<std::string> kept;
    for (const std::vector<std::string> &of_rank : gather(comm, own))
      kept.insert(kept.end(), of_rank.begin(), of_rank.end());
    kept.resize(std::min(kept.size(), at(Findings::kept_of_each_kind)));
    broadcast(comm, kept);
    for (const std::string &text : kept)
      texts.push_back(std::string(1, static_cast<char>(kind)) + text);
  }
  report.first_violations.clear();
  for (const std::string &text : texts)
    report.first_violations.push_back({static_cast<ViolationKind>(text.front()), text.substr(1)});
  return report;
}

/// Local: reads every own slab once.
Gathered gather(SlabSource &source, const validation::Ownership &owners,
                std::span<const validation::GhostNotice> ghosts, Findings &findings,
                const Progress &progress) {
  const DistributedMesh &common = source.common();
  const int first = common.first_slab, count = source.own_slab_count();
  const GlobalIndex triangles =
      common.triangle_offsets[at(first + count)] - common.triangle_offsets[at(first)];
  ProgressCount done(progress, "check", static_cast<double>(std::max<GlobalIndex>(triangles, 1)));
  Gathered gathered;
  for (int k = 0; k < count; ++k) {
    const SlabMesh &slab = source.slab(k);
    const int s = first + k;
    if (!validation::gather_layout(common, slab, at(s), gathered, findings))
      continue;
    validation::gather_order(common, slab, gathered, findings);
    if (common.triangle_count() > 0) {
      validation::gather_triangles(common, slab, s, done, findings);
      validation::gather_borders(slab, s, gathered);
      validation::gather_hull(slab, gathered, findings);
      validation::gather_paths(common, slab, s, owners, gathered);
      validation::gather_sites(slab, s, ghosts, findings);
    }
    validation::gather_sums(slab, source.duplicates(k), gathered, findings);
  }
  return gathered;
}

ValidationReport run(const Communicator &comm, SlabSource &source, const PointTable *points,
                     const Progress &progress) {
  const DistributedMesh &common = source.common();
  Findings findings;
  const std::vector<int> first_slabs = validation::check_common(comm, source, findings);
  if (first_slabs.empty())
    return combine(comm, findings);
  const validation::Ownership owners(common, first_slabs);
  const std::vector<validation::GhostNotice> ghosts = validation::ghosts_of_own_sites(comm, source, owners);
  const Gathered gathered = collectively(comm, validation::checking_text,
                                         [&] { return gather(source, owners, ghosts, findings, progress); });
  if (!validation::check_soundness(comm, common, gathered, findings))
    return combine(comm, findings);
  validation::check_order_across_ranks(comm, common, gathered, findings);
  if (common.triangle_count() == 0) {
    validation::check_collinear(comm, source, gathered, findings);
  } else {
    validation::check_borders(comm, owners, gathered, findings);
    validation::check_hull(comm, common, owners, gathered, findings);
    validation::check_paths(comm, common, owners, gathered, findings);
  }
  validation::check_sums(comm, common, gathered, findings);
  if (points != nullptr)
    validation::check_input(comm, source, *points, findings);
  return combine(comm, findings);
}

} // namespace

std::string_view name_of(ViolationKind kind) {
  static constexpr std::array<std::string_view, violation_kinds> names{
      "layout",    "coordinate", "order",     "line",     "orientation", "slab",
      "adjacency", "delaunay",   "hull",      "euler",    "unused_site", "collinear",
      "ghost",     "path",       "duplicate", "checksum", "digest",      "input"};
  return names[at(kind)];
}

ValidationReport validate(const Communicator &comm, const DistributedMesh &mesh, const Progress &progress) {
  SlabsInMemory source(mesh);
  return run(comm, source, nullptr, progress);
}

ValidationReport validate(const Communicator &comm, const DistributedMesh &mesh, const PointTable &points,
                          const Progress &progress) {
  SlabsInMemory source(mesh);
  return run(comm, source, &points, progress);
}

ValidationReport validate(const Communicator &comm, SlabSource &source, const Progress &progress) {
  return run(comm, source, nullptr, progress);
}

ValidationReport validate(const Communicator &comm, SlabSource &source, const PointTable &points,
                          const Progress &progress) {
  return run(comm, source, &points, progress);
}

void require_sound_layout(const Communicator &comm, const DistributedMesh &mesh, const std::string &subject) {
  Findings findings;
  const SlabsInMemory source(mesh);
  if (!validation::check_common(comm, source, findings).empty()) {
    Gathered gathered;
    for (std::size_t k = 0; k < mesh.slabs.size(); ++k)
      validation::gather_layout(mesh, mesh.slabs[k], at(mesh.first_slab) + k, gathered, findings);
    if (validation::check_soundness(comm, mesh, gathered, findings))
      return;
  }
  const ValidationReport report = combine(comm, findings);
  throw Error(
      {ErrorKind::input, subject, "",
       report.first_violations.empty() ? "the mesh contradicts itself" : report.first_violations.front().text,
       "make the mesh again"});
}

} // namespace dovetail
