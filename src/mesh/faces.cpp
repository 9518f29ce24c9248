#include "faces.hpp"

#include "dovetail/base/error.hpp"
#include "dovetail/base/huge_pages.hpp"

#include <algorithm>

namespace dovetail {
namespace {

constexpr std::size_t index(LocalIndex i) { return static_cast<std::size_t>(i); }

/// The side of triangle `across` that comes back from `to`, without a branch that would be guessed wrong.
std::size_t side_from(const Triangulation &mesh, std::size_t across, LocalIndex to) {
  const LocalIndex *const corner = &mesh.corners[3 * across];
  return static_cast<std::size_t>(corner[2] == to) + 2 * static_cast<std::size_t>(corner[0] == to);
}

} // namespace

Faces faces_of(const Triangulation &mesh, std::size_t room) {
  const auto count = index(mesh.triangle_count());
  if (count > most_faces)
    throw Error({ErrorKind::resource, "triangles", "", "a domain has too many for one process", ""});
  Faces result;
  reserve_huge(result.faces, std::max(count, room));
  for (std::size_t t = 0; t < count; ++t) {
    const LocalIndex *const corner = &mesh.corners[3 * t];
    Face face{{corner[0], corner[1], corner[2]}, {none, none, none}, none, 0, 0, 0};
    for (std::size_t i = 0; i < 3; ++i)
      if (const LocalIndex across = mesh.neighbours[3 * t + i]; across != none)
        face.twin[i] = static_cast<HalfEdge>(4 * index(across) +
                                             side_from(mesh, index(across), corner[i == 0 ? 2 : i - 1]));
    result.faces.push_back(face);
  }
  return result;
}

Faces faces_of(const DomainMesh &mesh, std::size_t room) {
  Faces result = faces_of(mesh.triangles, room);
  for (LocalIndex t = 0; t < result.count(); ++t) {
    result.face(t).region = mesh.region[index(t)];
    for (LocalIndex i = 0; i < 3; ++i)
      if (const LocalIndex segment = mesh.segment_of_side[index(3 * t + i)]; segment != none)
        result.set_segment(4 * t + i, segment);
  }
  return result;
}

LocalIndex Faces::add() {
  if (faces.size() == faces.capacity())
    reserve_huge(faces, 2 * faces.size() + 16);
  faces.emplace_back();
  return static_cast<LocalIndex>(faces.size() - 1);
}

void Faces::grow_segment_of() {
  reserve_huge(segment_of, 4 * faces.capacity());
  segment_of.resize(4 * faces.size());
}

namespace {

/// Sets triangle `to` from a face, whose twins are numbered by `number`.
void collect_face(const Faces &faces, LocalIndex t, LocalIndex to, auto number, DomainMesh &mesh) {
  const Face &face = faces.face(t);
  const std::size_t base = 3 * index(to);
  mesh.region[index(to)] = face.region;
  for (std::size_t i = 0; i < 3; ++i) {
    const HalfEdge twin = face.twin[i];
    mesh.triangles.corners[base + i] = face.corner[i];
    mesh.triangles.neighbours[base + i] = twin == none ? none : number(face_of(twin));
    mesh.segment_of_side[base + i] = none;
  }
  if (face.segment_sides != 0)
    for (LocalIndex i = 0; i < 3; ++i)
      mesh.segment_of_side[base + index(i)] = faces.segment(4 * t + i);
}

} // namespace

void collect_faces(const Faces &faces, DomainMesh &mesh) {
  std::vector<LocalIndex> number; // empty if all stay what they are
  LocalIndex kept = faces.count();
  if (std::ranges::any_of(faces.faces, [](const Face &face) { return face.mark != 0; })) {
    number.reserve(index(faces.count()));
    kept = 0;
    for (const Face &face : faces.faces)
      number.push_back(face.mark == 0 ? kept++ : none);
  }
  const std::size_t sides = 3 * index(kept);
  reserve_huge(mesh.triangles.corners, sides);
  reserve_huge(mesh.triangles.neighbours, sides);
  reserve_huge(mesh.segment_of_side, sides);
  mesh.triangles.corners.resize(sides);
  mesh.triangles.neighbours.resize(sides);
  mesh.segment_of_side.resize(sides);
  reserve_huge(mesh.region, index(kept));
  mesh.region.resize(index(kept));
  for (LocalIndex t = 0; t < faces.count(); ++t) {
    if (number.empty())
      collect_face(
          faces, t, t, [](LocalIndex beyond) { return beyond; }, mesh);
    else if (number[index(t)] != none)
      collect_face(
          faces, t, number[index(t)], [&](LocalIndex beyond) { return number[index(beyond)]; }, mesh);
  }
}

} // namespace dovetail
