/// Is a triangulation the canonical Delaunay triangulation of its sites? Decided in exact arithmetic that
/// shares no filter with the code that made it. Local.
///
/// The criterion (include/dovetail/README.md): every triangle counter-clockwise, adjacency symmetric, every
/// inner edge locally Delaunay by the canonical rule, and the boundary one cycle that goes once up and once
/// down in lexicographic order and turns left or straight everywhere. Triangles that pass these cover the
/// convex hull of the boundary once; that every site is used then makes it the triangulation of the sites.
#pragma once

#include "dovetail/mesh/triangulation.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dovetail {

enum class FaultKind : std::uint8_t {
  layout,      ///< array sizes and index ranges do not fit together; nothing else is checked then
  orientation, ///< a triangle is not counter-clockwise, or has a corner twice
  adjacency,   ///< a neighbour does not have the same edge, reversed, with this triangle beyond
  delaunay,    ///< an inner edge is not locally Delaunay by the canonical rule
  hull,        ///< the boundary is not one convex cycle
  euler,       ///< triangles != 2 sites - 2 - hull edges
  unused_site, ///< a site is in no triangle
  collinear,   ///< there are no triangles, but the sites are not on one line
};
inline constexpr std::size_t fault_kinds = 8;

/// Such as "adjacency": for reports.
std::string_view name_of(FaultKind kind);

struct Fault {
  FaultKind kind;
  LocalIndex triangle; ///< `none` for what concerns no single triangle
  std::string text;    ///< which side, sites, coordinates
};

struct FaultReport {
  GlobalIndex inner_edges = 0; ///< each tested once
  GlobalIndex hull_edges = 0;
  GlobalIndex fault_count = 0;
  std::array<GlobalIndex, fault_kinds> faults_by_kind{}; ///< by FaultKind
  std::vector<Fault> first_faults;                       ///< in the order found, not more than were asked for
  bool valid() const { return fault_count == 0; }
  GlobalIndex count(FaultKind kind) const { return faults_by_kind[static_cast<std::size_t>(kind)]; }
};

/// All checks; never throws for a broken triangulation. One or two exact predicates an edge and a triangle;
/// memory for one index and one byte a site.
FaultReport validate(std::span<const Point> sites, const Triangulation &mesh, std::size_t faults_kept = 20);

// The checks one by one, for triangulations that are a part of something larger. All need a sound layout.

/// Three corners a triangle, each a vertex; as many neighbours, each `none` or a triangle.
bool layout_is_sound(std::size_t vertex_count, const Triangulation &mesh);

/// Exactly; false also if a corner occurs twice.
bool is_counter_clockwise(std::span<const Point> vertices, const Triangulation &mesh, LocalIndex triangle);

/// Side i of a triangle runs from corner i + 1 to corner i + 2. True for a side with neighbour `none`.
bool adjacency_is_symmetric(const Triangulation &mesh, LocalIndex triangle, int side);

/// By the canonical rule; a, b, c counter-clockwise, d the apex beyond any of its sides.
bool is_locally_delaunay(Point a, Point b, Point c, Point d);

/// What is wrong with a closed boundary given as the sequence of its vertices, counter-clockwise: an empty
/// text if it goes once up and once down in lexicographic order and turns left or straight everywhere.
std::string fault_of_boundary(std::span<const Point> cycle);

} // namespace dovetail
