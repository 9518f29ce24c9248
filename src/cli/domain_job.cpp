#include "domain_job.hpp"

#include "text.hpp"

#include "dovetail/base/error.hpp"
#include "dovetail/io/domain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <new>
#include <utility>

namespace dovetail::cli {
namespace {

const std::map<std::string, CrossingRule> crossing_rules{{"split", CrossingRule::split},
                                                         {"error", CrossingRule::refuse}};
const std::map<std::string, HoleRule> hole_rules{{"seeds", HoleRule::seeds},
                                                 {"even-odd", HoleRule::even_odd}};

[[noreturn]] void refuse_crossing(const DomainFile &file, const SegmentCrossing &crossing) {
  throw Error({ErrorKind::input, file.path, name_of_segment(file, crossing.first),
               fmt::format("it crosses {} near ({}, {})", name_of_segment(file, crossing.second),
                           crossing.place.x, crossing.place.y),
               "let --crossings split give both a vertex there, or correct the domain"});
}

/// Vertices of the graph keep the number and attributes of the first equal vertex given.
void describe_vertices(const DomainFile &file, DomainJob &job) {
  constexpr double no_value = std::numeric_limits<double>::quiet_NaN();
  const std::size_t count = job.planar.graph.vertices.size();
  DomainVertices &vertices = job.vertices;
  for (const Attribute &attribute : file.attributes)
    vertices.attributes.push_back({attribute.name, std::vector<double>(count, no_value)});
  for (std::size_t i = 0; i < file.set.vertices.size(); ++i) {
    const LocalIndex v = job.planar.vertex_of_input[i];
    const auto number = static_cast<GlobalIndex>(i);
    if (static_cast<std::size_t>(v) < vertices.input_index.size()) {
      vertices.duplicates.push_back({number, v});
      continue;
    }
    vertices.input_index.push_back(number);
    for (std::size_t a = 0; a < file.attributes.size(); ++a)
      vertices.attributes[a].values[static_cast<std::size_t>(v)] = file.attributes[a].values[i];
  }
  for (std::size_t v = vertices.input_index.size(), next = file.set.vertices.size(); v < count; ++v)
    vertices.input_index.push_back(static_cast<GlobalIndex>(next++));
}

/// "3 holes' seeds have no effect: 2 outside, ..."
std::string stray_text(const char *what, const std::vector<StraySeed> &strays) {
  const auto count = [&](SeedFault fault) { return std::ranges::count(strays, fault, &StraySeed::fault); };
  std::vector<std::string> reasons;
  for (const auto &[fault, words] : {std::pair{SeedFault::outside, "outside of the domain"},
                                     std::pair{SeedFault::on_segment, "on a segment"},
                                     std::pair{SeedFault::taken, "in a region that has a seed before it"}})
    if (const auto n = count(fault); n > 0)
      reasons.push_back(fmt::format("{} {}", n, words));
  return fmt::format("{} without effect: {}", counted(std::ssize(strays), what, std::string(what) + "s"),
                     joined(reasons, ", "));
}

/// A want of memory in `work` is told of the domain: where there is one rank, more of them do not help.
template <class Work> auto within_memory(const std::string &path, Work &&work) {
  try {
    return std::forward<Work>(work)();
  } catch (const std::bad_alloc &) {
    throw Error({ErrorKind::resource, path, "", "the domain takes more memory than there is",
                 "mesh it in parts, or where there is more"});
  }
}

/// As domain_of_file(), of what was read.
DomainJob job_of(DomainFile file, const DomainOptions &options) {
  if (options.holes != HoleRule::by_format)
    file.set.even_odd = options.holes == HoleRule::even_odd;
  DomainJob job;
  job.input = file.path;
  job.given_vertices = std::ssize(file.set.vertices);
  job.given_segments = std::ssize(file.set.segments);
  job.closed_rings = file.closed_rings;
  if (file.heights > 0)
    job.notices.push_back(
        fmt::format("{} left out: domains are flat", counted(file.heights, "height", "heights")));
  if (!file.set.holes.empty() && options.holes == HoleRule::even_odd)
    job.notices.push_back("seeds of holes count beside even-odd nesting");
  try {
    job.planar = planarise(file.set, options.crossings);
  } catch (const Error &error) {
    Problem problem = error.problem();
    problem.subject = file.path;
    throw Error(problem);
  }
  if (job.planar.refused)
    refuse_crossing(file, *job.planar.refused);
  describe_vertices(file, job);
  return job;
}

} // namespace

void add_domain_options(CLI::App &parser, DomainOptions &options) {
  add_word_option(parser, "--crossings", options.crossings, crossing_rules,
                  "Segments that cross get a common vertex, or are refused")
      ->option_text("split|error [split]");
  add_word_option(parser, "--holes", options.holes, hole_rules,
                  "Holes are where seeds are [.poly], or between nested outlines [GeoJSON]")
      ->option_text("seeds|even-odd");
  parser.add_flag("--convex", options.convex,
                  "Keep the whole convex hull of a domain but for holes with seeds");
}

void require_one_rank(const Session &session, const std::string &subcommand) {
  if (session.comm.size() > 1)
    throw Error({ErrorKind::usage, subcommand, "",
                 fmt::format("works on one rank, and this run has {}", session.comm.size()),
                 "start it without mpirun; domains are not meshed in parallel yet"});
}

DomainJob domain_of_file(const std::string &path, const DomainOptions &options) {
  return within_memory(path, [&] { return job_of(read_domain(path), options); });
}

Constrained constrain_domain(DomainJob &job, const ConstrainOptions &options) {
  Constrained result = within_memory(job.input, [&] { return constrain(job.planar.graph, options); });
  if (result.mesh.triangles.triangle_count() == 0) {
    const GlobalIndex ends = job.planar.repairs.hanging_ends;
    throw Error(
        {ErrorKind::input, job.input, "",
         !result.nothing_left ? fmt::format("it has no triangles: there are {} vertices, or all on one line",
                                            job.planar.graph.vertices.size())
         : ends > 0           ? fmt::format("nothing of it is inside: its outline is not closed ({})",
                                            counted(ends, "segment ends free", "segments end free"))
                              : "nothing of it is inside: no outline is closed, or holes are everywhere",
         !result.nothing_left ? "give an outline"
                              : "close the outline, correct holes, or mesh the convex hull (--convex)"});
  }
  if (!result.stray_holes.empty())
    job.notices.push_back(stray_text("hole seed", result.stray_holes));
  if (!result.stray_regions.empty())
    job.notices.push_back(stray_text("region seed", result.stray_regions));
  return result;
}

DomainRecord record_of(const DomainJob &job, const Constrained &constrained) {
  const PlanarGraph &graph = job.planar.graph;
  DomainRecord record;
  record.segments = graph.segments;
  record.segments.insert(record.segments.end(), constrained.hull_segments.begin(),
                         constrained.hull_segments.end());
  record.hull_segments = std::ssize(constrained.hull_segments);
  record.is_line = graph.is_line;
  record.holes = graph.holes;
  record.regions = graph.regions;
  record.even_odd = graph.even_odd;
  record.chain_offsets = job.planar.chain_offsets;
  record.chain_vertices = job.planar.chain_vertices;
  record.given_vertices = job.given_vertices;
  return record;
}

void number_new_vertices(std::size_t count, DomainVertices &vertices) {
  GlobalIndex next = 0;
  for (const GlobalIndex number : vertices.input_index)
    next = std::max(next, number + 1);
  for (const Duplicate &duplicate : vertices.duplicates)
    next = std::max(next, duplicate.input_index + 1);
  while (vertices.input_index.size() < count)
    vertices.input_index.push_back(next++);
  for (Attribute &attribute : vertices.attributes)
    attribute.values.resize(count, std::numeric_limits<double>::quiet_NaN());
}

std::string repairs_text(const DomainJob &job) {
  const PlanarRepairs &repairs = job.planar.repairs;
  std::vector<std::string> parts;
  const auto add = [&](GlobalIndex count, const char *one, const char *many) {
    if (count > 0)
      parts.push_back(counted(count, one, many));
  };
  add(repairs.duplicate_vertices, "duplicate vertex merged", "duplicate vertices merged");
  add(repairs.zero_length, "segment without length dropped", "segments without length dropped");
  add(repairs.repeated, "repeated segment merged", "repeated segments merged");
  add(repairs.overlapping, "overlapping segment merged", "overlapping segments merged");
  add(repairs.junctions, "junction divides a segment", "junctions divide segments");
  add(repairs.vertices_on_segments, "vertex divides a segment", "vertices divide segments");
  add(repairs.crossings, "crossing split", "crossings split");
  add(repairs.pulled, "vertex holds a bend", "vertices hold bends");
  add(job.closed_rings, "ring closed", "rings closed");
  add(repairs.hanging_ends, "segment ends free", "segments end free");
  add(repairs.lone_vertices, "vertex without segments", "vertices without segments");
  return parts.empty() ? "none needed" : joined(parts, ", ");
}

Report repairs_as_json(const DomainJob &job) {
  const PlanarRepairs &repairs = job.planar.repairs;
  Report json;
  json["duplicate_vertices"] = repairs.duplicate_vertices;
  json["zero_length_segments"] = repairs.zero_length;
  json["repeated_segments"] = repairs.repeated;
  json["overlapping_segments"] = repairs.overlapping;
  json["junctions"] = repairs.junctions;
  json["vertices_on_segments"] = repairs.vertices_on_segments;
  json["crossings"] = repairs.crossings;
  json["pulled_vertices"] = repairs.pulled;
  json["closed_rings"] = job.closed_rings;
  json["hanging_ends"] = repairs.hanging_ends;
  json["lone_vertices"] = repairs.lone_vertices;
  return json;
}

void report_domain(const DistributedMesh &mesh, Report &report) {
  report_counts(report, mesh);
  report["points"] = record_of(mesh).given_vertices;
  report["duplicates"] = std::ssize(mesh.duplicates);
  report["segments"] = std::ssize(record_of(mesh).segments);
}

} // namespace dovetail::cli
