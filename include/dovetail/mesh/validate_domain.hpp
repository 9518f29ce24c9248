/// Is a mesh of a domain right? Decided in exact arithmetic that shares no filter with the code that made it.
/// Local.
///
/// Every triangle counter-clockwise; adjacency symmetric; every edge that is no piece of a segment locally
/// Delaunay by the canonical rule; the boundary made of pieces of segments; the pieces of every segment one
/// chain from one end to the other; the triangles' area that of the domain with straight segments; Euler's
/// relation over components, holes and pinched vertices; no angle below the bound but for the exceptions that
/// mesh/refine.hpp states.
#pragma once

#include "dovetail/mesh/domain.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dovetail {

enum class DomainFaultKind : std::uint8_t {
  layout,      ///< array sizes and index ranges do not fit together; nothing else is checked then
  orientation, ///< a triangle is not counter-clockwise, or has a corner twice
  adjacency,   ///< a neighbour does not have the same edge, reversed, with this triangle beyond
  delaunay,    ///< an edge that is no piece of a segment is not locally Delaunay by the canonical rule
  boundary,    ///< a boundary side that is no piece of a segment
  segment,     ///< the two sides of an edge disagree about its segment, or two regions meet without one
  chain,       ///< the pieces of a segment are not one chain between its ends, or leave it
  area,        ///< triangles cover more or less than the domain
  euler,       ///< triangles overlap or are missing, as counts show
  angle,       ///< below the bound, and no exception
};
inline constexpr std::size_t domain_fault_kinds = 10;

/// Such as "adjacency": for reports.
std::string_view name_of(DomainFaultKind kind);

struct DomainFault {
  DomainFaultKind kind;
  LocalIndex triangle; ///< `none` for what concerns no single triangle
  std::string text;    ///< which side, vertices, coordinates
};

struct DomainReport {
  GlobalIndex inner_edges = 0;      ///< not pieces of segments, each tested once
  GlobalIndex pieces = 0;           ///< edges that are pieces of segments
  GlobalIndex boundary_edges = 0;   ///< of these, on the boundary
  GlobalIndex vertices = 0;         ///< in some triangle
  GlobalIndex components = 0;       ///< of triangles that share sides
  GlobalIndex boundaries = 0;       ///< closed curves, each as seen from within: outlines and holes
  GlobalIndex pinched = 0;          ///< times a vertex is met again, on its own or another boundary
  GlobalIndex missing_segments = 0; ///< segments without a piece: outside of the domain
  GlobalIndex exempt_triangles = 0; ///< below the angle bound, and legitimate exceptions
  double smallest_angle = 180;      ///< degrees
  double area = 0;
  double bend = 0; ///< greatest distance of a chain from its segment, in lengths of the segment
  GlobalIndex fault_count = 0;
  std::array<GlobalIndex, domain_fault_kinds> faults_by_kind{}; ///< by DomainFaultKind
  std::vector<DomainFault> first_faults;                        ///< in the order found
  bool valid() const { return fault_count == 0; }
  GlobalIndex count(DomainFaultKind kind) const { return faults_by_kind[static_cast<std::size_t>(kind)]; }
};

/// All checks; never throws for a broken mesh. `segments`: those that segment_of_side counts, the graph's and
/// behind them Constrained::hull_segments. `min_angle` in degrees, 0: no bound. Expected linear in the mesh.
DomainReport validate_domain(const DomainMesh &mesh, std::span<const Segment> segments, double min_angle = 0,
                             std::size_t faults_kept = 20);

} // namespace dovetail
