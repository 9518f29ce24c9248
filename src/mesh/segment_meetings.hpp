/// Which segments cross, and which vertices lie on or next to them. Private to mesh.
#pragma once

#include "dovetail/base/types.hpp"

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace dovetail {

/// The two ends of a piece of a segment.
struct Piece {
  LocalIndex from;
  LocalIndex to;
  friend constexpr bool operator==(const Piece &, const Piece &) = default;
};

struct Meetings {
  std::vector<std::pair<LocalIndex, LocalIndex>> crossings; ///< pieces that cross inside both
  std::vector<std::pair<LocalIndex, LocalIndex>> beside;    ///< a piece, and a vertex on it or beside it
};

/// Whether p, collinear with a and b, is strictly between them.
constexpr bool is_between(Point a, Point b, Point p) {
  return lexicographically_less(a, b) ? lexicographically_less(a, p) && lexicographically_less(p, b)
                                      : lexicographically_less(b, p) && lexicographically_less(p, a);
}

/// All meetings among the pieces whose numbers are in `live` that have a piece from number `new_piece` on or
/// a vertex from number `new_vertex` on; each once, in ascending order. Crossings are exact. A vertex that is
/// no end of a piece is beside it if it is on it, or nearer than 2^-48 of its largest coordinate (where
/// rounding cannot reach farther), or a little more. Vertices are distinct.
///
/// The plane is cut in two again and again, where the vertices are, until few pieces or one common vertex are
/// left, or cutting does not help any more because the pieces are long and close together. Such pieces are
/// swept over along their direction (mesh/strips.hpp).
Meetings find_meetings(std::span<const Point> vertices, std::span<const Piece> pieces,
                       std::vector<LocalIndex> live, std::size_t new_piece, std::size_t new_vertex);

} // namespace dovetail
