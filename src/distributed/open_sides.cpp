#include "open_sides.hpp"

#include "dovetail/base/error.hpp"

#include <algorithm>
#include <iterator>

namespace dovetail {
namespace {

/// Who knows the mesh's name adds it.
[[noreturn]] void refuse(const char *what) {
  throw Error({ErrorKind::input, "", "", what,
               "dovetail verify tells what is wrong with it; make it again from its points"});
}

/// Turns about a vertex, from the side h of a triangle and by `next` to that of the neighbour, to the side
/// that has no neighbour.
template <class Next> HalfEdge turn(const Triangulation &triangles, HalfEdge h, Next &&next) {
  LocalIndex turns = 0;
  for (HalfEdge across = sound_twin(triangles, h); across != none; across = sound_twin(triangles, h)) {
    if (++turns > triangles.triangle_count())
      refuse("triangles go round a vertex without end");
    h = next(across);
  }
  return h;
}

} // namespace

HalfEdge sound_twin(const Triangulation &triangles, HalfEdge h) {
  const LocalIndex beyond = triangles.neighbours[position(h)];
  if (beyond == none)
    return none;
  // Any of its sides is as likely, so it is found without a branch; it is the fourth of three if two sides
  // have the same triangle beyond, as none do in the plane.
  const HalfEdge across = half_edge_towards(triangles, beyond, triangle_of(h));
  if (across == half_edge(beyond, 3) || triangles.neighbours[position(across)] != triangle_of(h) ||
      origin(triangles, across) != target(triangles, h) || target(triangles, across) != origin(triangles, h))
    refuse("two triangles do not agree that they are neighbours");
  return across;
}

HalfEdge open_side_after(const Triangulation &triangles, HalfEdge h) {
  return turn(triangles, after(h), after);
}

HalfEdge open_side_before(const Triangulation &triangles, HalfEdge h) {
  return turn(triangles, before(h), before);
}

std::vector<LocalIndex> open_sides(const Triangulation &triangles) {
  std::vector<LocalIndex> sides;
  for (std::size_t side = 0; side < triangles.neighbours.size(); ++side)
    if (triangles.neighbours[side] == none)
      sides.push_back(static_cast<LocalIndex>(side));
  return sides;
}

std::vector<LocalIndex> open_sides_around(const Triangulation &triangles, std::span<const LocalIndex> some) {
  std::vector<bool> seen(triangles.neighbours.size(), false);
  std::vector<LocalIndex> sides;
  for (const LocalIndex start : some) { // on the way each step would wait for memory
    __builtin_prefetch(&triangles.neighbours[position(start)]);
    __builtin_prefetch(&triangles.corners[position(start)]);
  }
  for (const LocalIndex start : some)
    for (HalfEdge side = start; !seen[position(side)]; side = open_side_after(triangles, side)) {
      seen[position(side)] = true;
      sides.push_back(side);
    }
  std::ranges::sort(sides);
  return sides;
}

std::vector<LocalIndex> open_sides(const SlabMesh &slab) {
  std::vector<LocalIndex> borders;
  std::ranges::transform(slab.border_sides, std::back_inserter(borders), &BorderSide::side);
  // Every piece of a slab has a border on it, unless it is the whole mesh.
  return borders.empty() ? open_sides(slab.triangles) : open_sides_around(slab.triangles, borders);
}

} // namespace dovetail
