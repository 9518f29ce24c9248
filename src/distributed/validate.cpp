#include "dovetail/distributed/validate.hpp"

#include "validation.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/serialization.hpp"

#include <fmt/format.h>

namespace dovetail {
namespace validation {

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

ValidationReport run(const Communicator &comm, const DistributedMesh &mesh, const PointTable *points,
                     const Progress &progress) {
  Findings findings;
  const std::vector<int> first_slabs = validation::check_layout(comm, mesh, findings);
  if (first_slabs.empty() || !validation::check_coordinates(comm, mesh, findings))
    return combine(comm, findings);
  const validation::Ownership owners(mesh, first_slabs);
  validation::check_order_and_lines(comm, mesh, findings);
  if (mesh.triangle_count() == 0) {
    validation::check_collinear(comm, mesh, findings);
  } else {
    collectively(comm, validation::checking_text,
                 [&] { validation::check_triangles(mesh, findings, progress); });
    validation::check_borders(comm, mesh, owners, findings);
    validation::check_hull(comm, mesh, owners, findings);
    validation::check_ghosts_and_use(comm, mesh, owners, findings);
    validation::check_paths(comm, mesh, owners, findings);
  }
  validation::check_checksum(comm, mesh, findings);
  validation::check_duplicates_and_digest(comm, mesh, findings);
  if (points != nullptr)
    validation::check_input(comm, mesh, *points, findings);
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
  return run(comm, mesh, nullptr, progress);
}

ValidationReport validate(const Communicator &comm, const DistributedMesh &mesh, const PointTable &points,
                          const Progress &progress) {
  return run(comm, mesh, &points, progress);
}

void require_sound_layout(const Communicator &comm, const DistributedMesh &mesh, const std::string &subject) {
  Findings findings;
  if (!validation::check_layout(comm, mesh, findings).empty() &&
      validation::check_coordinates(comm, mesh, findings))
    return;
  const ValidationReport report = combine(comm, findings);
  throw Error(
      {ErrorKind::input, subject, "",
       report.first_violations.empty() ? "the mesh contradicts itself" : report.first_violations.front().text,
       "make the mesh again"});
}

} // namespace dovetail
