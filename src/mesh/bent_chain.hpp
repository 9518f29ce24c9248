/// A piece of a segment that is divided at rounded points. Private to mesh.
#pragma once

#include "segment_meetings.hpp"

#include "dovetail/base/sign.hpp"

#include <cstddef>
#include <span>
#include <unordered_set>
#include <vector>

namespace dovetail {

/// The vertices that a piece goes through, in order along its longer direction.
///
///             w                        The chain a b is to go through w, beside it. Of the vertices in the
///          . / \ .                     triangle, p would change sides; so the chain goes a p w b. What is
///       .   p   \   .                  right of p along the piece is looked at from w to b likewise.
///     a-----------------b
class BentChain {
public:
  /// `beside`: the vertices that a bend could sweep, in any order.
  BentChain(std::span<const Point> vertices, Piece piece, std::span<const LocalIndex> beside);

  /// By vertices that are exactly on the piece, between its ends.
  void divide(std::vector<LocalIndex> on_piece);
  /// To vertices within rounding of the piece and in its bounding box. Comes after divide.
  void bend(std::vector<LocalIndex> bends);

  const std::vector<LocalIndex> &vertices() const { return chain_; }
  /// Vertices that the chain was pulled through.
  std::size_t pulled() const { return pulled_; }

private:
  void bend_to(LocalIndex w);
  Point point(LocalIndex v) const { return vertices_[static_cast<std::size_t>(v)]; }
  /// Along the piece, in exact coordinates.
  bool is_before(LocalIndex p, LocalIndex q) const;
  std::vector<LocalIndex> swept(LocalIndex a, LocalIndex w, LocalIndex b) const;
  void append_taut(std::vector<LocalIndex> &path, std::span<const LocalIndex> obstacles, LocalIndex to,
                   Sign side) const;

  std::span<const Point> vertices_;
  std::span<const LocalIndex> beside_;
  bool by_x_, ascending_, other_ascending_;
  std::vector<LocalIndex> chain_;
  std::unordered_set<LocalIndex> members_; ///< of the chain
  std::size_t pulled_ = 0;
};

} // namespace dovetail
