/// What constrain and refine have in common: from files to a graph in order, and from a mesh to files.
#pragma once

#include "options.hpp"
#include "report.hpp"

#include "dovetail/distributed/domain_slab.hpp"
#include "dovetail/mesh/constrain.hpp"
#include "dovetail/mesh/planarise.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dovetail::cli {

/// How holes are found.
enum class HoleRule : std::uint8_t {
  by_format, ///< seeds in a .poly, even-odd in GeoJSON
  seeds,
  even_odd,
};

struct DomainOptions {
  CrossingRule crossings = CrossingRule::split;
  HoleRule holes = HoleRule::by_format;
  bool convex = false; ///< keep the whole hull
};
/// Adds --crossings, --holes and --convex.
void add_domain_options(CLI::App &parser, DomainOptions &options);

/// A planar graph, and what its vertices are in the input.
struct DomainJob {
  std::string input;
  Planarised planar;
  DomainVertices vertices; ///< of the graph
  GlobalIndex given_vertices = 0, given_segments = 0;
  GlobalIndex closed_rings = 0;     ///< of GeoJSON
  std::vector<std::string> notices; ///< of what was left out
};

/// Throws an Error (usage) on more than one rank: there is no distributed driver, and nothing is gathered
/// silently.
void require_one_rank(const Session &session, const std::string &subcommand);

/// Reads a domain file and brings it in order. Errors (input): as read_domain and planarise, and crossing
/// segments that --crossings refuses; (resource): out of memory.
DomainJob domain_of_file(const std::string &path, const DomainOptions &options);

/// As above, of the graph's constrained triangulation; notices seeds without effect. Errors (input): no
/// triangle is left; (resource): out of memory.
Constrained constrain_domain(DomainJob &job, const ConstrainOptions &options);

/// The record of a mesh made from a graph.
DomainRecord record_of(const DomainJob &job, const Constrained &constrained);

/// Input indices for vertices behind those known: behind all points given, and those made before.
void number_new_vertices(std::size_t count, DomainVertices &vertices);

/// What was mended, for people: "12 crossings split, 3 duplicate vertices merged", or "nothing".
std::string repairs_text(const DomainJob &job);
Report repairs_as_json(const DomainJob &job);

/// The counts that all reports of a mesh of a domain have.
void report_domain(const DistributedMesh &mesh, Report &report);

} // namespace dovetail::cli
