/// The triangulation while it changes: one record a triangle, half-edges instead of neighbours. Private to
/// mesh.
///
/// Half-edge 4t + i, for i from 0 to 2, is the side of triangle t across from its corner i; it runs from
/// corner i + 1 to corner i + 2, with the triangle on its left.
#pragma once

#include "dovetail/mesh/domain.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace dovetail {

using HalfEdge = LocalIndex;

/// All that the search for a cavity reads of a triangle, in half a cache line.
struct alignas(32) Face {
  std::array<LocalIndex, 3> corner;
  std::array<HalfEdge, 3> twin; ///< `none` beyond the boundary
  std::int32_t region;
  std::uint8_t segment_sides; ///< bit i: side i is a piece of a segment
  std::uint8_t locked_sides;  ///< bit i: side i is locked
  std::uint8_t mark;          ///< for passes over all faces
};

/// Four half-edges a triangle, one of them unused, are numbered by LocalIndex.
inline constexpr std::size_t most_faces = (std::size_t{1} << 29) - 1;

constexpr LocalIndex face_of(HalfEdge h) { return h >> 2; }
constexpr int face_side(HalfEdge h) { return h & 3; }
constexpr HalfEdge next(HalfEdge h) { return face_side(h) == 2 ? h - 2 : h + 1; }
constexpr HalfEdge previous(HalfEdge h) { return face_side(h) == 0 ? h + 2 : h - 1; }

struct Faces {
  std::vector<Face> faces;
  /// By half-edge, valid where the bit of its side is set; it may end before the last half-edge, but not
  /// before the last with that bit.
  std::vector<LocalIndex> segment_of;

  Face &face(LocalIndex t) { return faces[static_cast<std::size_t>(t)]; }
  const Face &face(LocalIndex t) const { return faces[static_cast<std::size_t>(t)]; }
  /// One more, not set. References to faces do not last.
  LocalIndex add();
  LocalIndex count() const { return static_cast<LocalIndex>(faces.size()); }

  LocalIndex apex(HalfEdge h) const {
    return face(face_of(h)).corner[static_cast<std::size_t>(face_side(h))];
  }
  LocalIndex from(HalfEdge h) const { return apex(next(h)); }
  LocalIndex to(HalfEdge h) const { return apex(previous(h)); }
  HalfEdge twin(HalfEdge h) const { return face(face_of(h)).twin[static_cast<std::size_t>(face_side(h))]; }
  void set_twin(HalfEdge h, HalfEdge twin) {
    face(face_of(h)).twin[static_cast<std::size_t>(face_side(h))] = twin;
  }
  /// Either may be `none`.
  void link(HalfEdge a, HalfEdge b) {
    if (a != none)
      set_twin(a, b);
    if (b != none)
      set_twin(b, a);
  }

  bool is_segment(HalfEdge h) const { return (face(face_of(h)).segment_sides >> face_side(h) & 1) != 0; }
  /// The segment that h is a piece of, or `none`.
  LocalIndex segment(HalfEdge h) const {
    return is_segment(h) ? segment_of[static_cast<std::size_t>(h)] : none;
  }
  /// Of this side only.
  void set_segment(HalfEdge h, LocalIndex segment) {
    Face &f = face(face_of(h));
    f.segment_sides = static_cast<std::uint8_t>(f.segment_sides | 1U << face_side(h));
    if (static_cast<std::size_t>(h) >= segment_of.size())
      grow_segment_of();
    segment_of[static_cast<std::size_t>(h)] = segment;
  }
  /// To all half-edges that there are.
  void grow_segment_of();
};

/// Without segments, regions and marks, and with room for so many, if that is more. Local.
Faces faces_of(const Triangulation &mesh, std::size_t room = 0);
/// With them, and the locks not set.
Faces faces_of(const DomainMesh &mesh, std::size_t room);

/// Triangles, segments and regions of the faces without mark, in their order. Vertices are left alone.
void collect_faces(const Faces &faces, DomainMesh &mesh);

} // namespace dovetail
