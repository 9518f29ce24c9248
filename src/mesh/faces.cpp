#include "faces.hpp"

#include "dovetail/base/error.hpp"
#include "dovetail/base/huge_pages.hpp"

namespace dovetail {
namespace {

constexpr std::size_t index(LocalIndex i) { return static_cast<std::size_t>(i); }

/// The side of triangle `across` whose twin is side i of triangle t.
std::size_t side_back(const Triangulation &mesh, std::size_t across, std::size_t t, std::size_t i) {
  const LocalIndex to = mesh.corners[3 * t + (i + 2) % 3];
  std::size_t j = 0;
  while (j < 2 && mesh.corners[3 * across + (j + 1) % 3] != to)
    ++j;
  return j;
}

} // namespace

Faces faces_of(const Triangulation &mesh) {
  const auto count = index(mesh.triangle_count());
  if (count > most_faces)
    throw Error({ErrorKind::resource, "triangles", "", "a domain has too many for one process", ""});
  Faces result;
  reserve_huge(result.faces, count + count / 2);
  reserve_huge(result.segment_of, 4 * (count + count / 2));
  result.segment_of.resize(4 * count);
  for (std::size_t t = 0; t < count; ++t) {
    Face &face = result.faces.emplace_back(Face{{}, {}, none, 0, 0, 0});
    for (std::size_t i = 0; i < 3; ++i) {
      face.corner[i] = mesh.corners[3 * t + i];
      const LocalIndex across = mesh.neighbours[3 * t + i];
      face.twin[i] = across == none
                         ? none
                         : static_cast<HalfEdge>(4 * index(across) + side_back(mesh, index(across), t, i));
    }
  }
  return result;
}

Faces faces_of(const DomainMesh &mesh) {
  Faces result = faces_of(mesh.triangles);
  for (LocalIndex t = 0; t < result.count(); ++t) {
    result.face(t).region = mesh.region[index(t)];
    for (LocalIndex i = 0; i < 3; ++i)
      if (const LocalIndex segment = mesh.segment_of_side[index(3 * t + i)]; segment != none)
        result.set_segment(4 * t + i, segment);
  }
  return result;
}

void collect_faces(const Faces &faces, DomainMesh &mesh) {
  std::vector<LocalIndex> number(index(faces.count()), none);
  LocalIndex kept = 0;
  for (LocalIndex t = 0; t < faces.count(); ++t)
    if (faces.face(t).mark == 0)
      number[index(t)] = kept++;
  mesh.triangles.corners.resize(3 * index(kept));
  mesh.triangles.neighbours.resize(3 * index(kept));
  mesh.segment_of_side.resize(3 * index(kept));
  mesh.region.resize(index(kept));
  for (LocalIndex t = 0; t < faces.count(); ++t) {
    if (number[index(t)] == none)
      continue;
    const Face &face = faces.face(t);
    mesh.region[index(number[index(t)])] = face.region;
    for (LocalIndex i = 0; i < 3; ++i) {
      const std::size_t side = index(3 * number[index(t)] + i);
      const HalfEdge twin = face.twin[index(i)];
      mesh.triangles.corners[side] = face.corner[index(i)];
      mesh.triangles.neighbours[side] = twin == none ? none : number[index(face_of(twin))];
      mesh.segment_of_side[side] = faces.segment(4 * t + i);
    }
  }
}

} // namespace dovetail
