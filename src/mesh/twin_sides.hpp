/// Sides of triangles find each other by their ends. Private to mesh.
#pragma once

#include "dovetail/mesh/triangulation.hpp"

#include <cstddef>
#include <vector>

namespace dovetail {

/// Adds triangles to a triangulation and joins their sides: at once where both are known, and otherwise when
/// the second one comes.
class TwinSides {
public:
  TwinSides(std::size_t vertices, Triangulation &mesh) : mesh_(mesh), waiting_(vertices, none) {}

  /// Returns the side across from the first corner; those across from the others have the next two numbers.
  LocalIndex add(LocalIndex a, LocalIndex b, LocalIndex c) {
    if (used_ == mesh_.corners.size())
      grow();
    LocalIndex *corner = mesh_.corners.data() + used_;
    corner[0] = a;
    corner[1] = b;
    corner[2] = c;
    used_ += 3;
    return static_cast<LocalIndex>(used_ - 3);
  }

  /// Gives back what was taken in advance, when all triangles are there.
  void finish() {
    mesh_.corners.resize(used_);
    mesh_.neighbours.resize(used_);
  }

  void join(LocalIndex side, LocalIndex twin) {
    mesh_.neighbours[index(side)] = twin / 3;
    mesh_.neighbours[index(twin)] = side / 3;
  }

  /// The side goes from one vertex to the other, counter-clockwise around its triangle. O(sides of the vertex
  /// `to` that wait).
  void meet(LocalIndex side, LocalIndex from, LocalIndex to) {
    for (LocalIndex *link = &waiting_[index(to)]; *link != none; link = &sides_[index(*link)].next)
      if (const Waiting &found = sides_[index(*link)]; found.to == from) {
        join(side, found.side);
        const LocalIndex place = *link;
        *link = found.next;
        sides_[index(place)].next = free_;
        free_ = place;
        return;
      }
    LocalIndex place = free_;
    if (place == none) {
      place = static_cast<LocalIndex>(sides_.size());
      sides_.emplace_back();
    } else {
      free_ = sides_[index(place)].next;
    }
    sides_[index(place)] = {side, to, waiting_[index(from)]};
    waiting_[index(from)] = place;
  }

private:
  static std::size_t index(LocalIndex i) { return static_cast<std::size_t>(i); }

  /// A piece at a time, so that memory is filled with "no neighbour" when it is needed.
  void grow() {
    constexpr std::size_t piece = 3 * 1024;
    mesh_.corners.resize(used_ + piece);
    mesh_.neighbours.resize(used_ + piece, none);
  }

  struct Waiting {
    LocalIndex side, to, next;
  };
  Triangulation &mesh_;
  std::size_t used_ = 0;
  std::vector<LocalIndex> waiting_; ///< by vertex: the first of its sides that wait
  std::vector<Waiting> sides_;
  LocalIndex free_ = none; ///< the first place in sides_ that is not in use
};

} // namespace dovetail
