#include "size_field.hpp"

#include "dovetail/geometry/constructions.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>

namespace dovetail {
namespace {

constexpr std::size_t index(LocalIndex i) { return static_cast<std::size_t>(i); }

std::vector<double> local_features(std::span<const Point> vertices, const Faces &faces) {
  std::vector<double> feature(vertices.size(), HUGE_VAL);
  const auto lower = [&](LocalIndex v, double value) {
    feature[index(v)] = std::min(feature[index(v)], value);
  };
  for (HalfEdge h = 0; h < 4 * faces.count(); h = face_side(h) == 2 ? h + 2 : h + 1) {
    const Point from = vertices[index(faces.from(h))], to = vertices[index(faces.to(h))];
    const double length = distance(from, to);
    lower(faces.from(h), length);
    lower(faces.to(h), length);
    const Point apex = vertices[index(faces.apex(h))];
    if (faces.is_segment(h) && dot(apex - from, to - from) > 0 && dot(apex - to, from - to) > 0)
      lower(faces.apex(h), doubled_area(from, to, apex) / length);
  }
  return feature;
}

} // namespace

/// Dijkstra's algorithm from all vertices at once, over the edges of each vertex.
std::vector<double> local_sizes(std::span<const Point> vertices, const Faces &faces, double growth) {
  std::vector<double> size = local_features(vertices, faces);
  std::vector<std::size_t> first(vertices.size() + 1, 0); // of the half-edges that leave a vertex
  for (const Face &face : faces.faces)
    for (const LocalIndex v : face.corner)
      first[index(v) + 1] += 2;
  for (std::size_t v = 0; v < vertices.size(); ++v)
    first[v + 1] += first[v];
  std::vector<LocalIndex> neighbours(first.back());
  std::vector<std::size_t> end(first.begin(), first.end() - 1);
  for (const Face &face : faces.faces)
    for (std::size_t i = 0; i < 3; ++i)
      for (const std::size_t j : {(i + 1) % 3, (i + 2) % 3})
        neighbours[end[index(face.corner[i])]++] = face.corner[j];

  using Entry = std::pair<double, LocalIndex>;
  std::vector<Entry> entries;
  for (std::size_t v = 0; v < vertices.size(); ++v)
    if (size[v] < HUGE_VAL)
      entries.emplace_back(size[v], static_cast<LocalIndex>(v));
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue({}, std::move(entries));
  while (!queue.empty()) {
    const auto [of_v, v] = queue.top();
    queue.pop();
    if (of_v > size[index(v)])
      continue;
    for (std::size_t i = first[index(v)]; i < first[index(v) + 1]; ++i) {
      const LocalIndex u = neighbours[i];
      const double reached = of_v + growth * distance(vertices[index(v)], vertices[index(u)]);
      if (reached < size[index(u)]) {
        size[index(u)] = reached;
        queue.emplace(reached, u);
      }
    }
  }
  return size;
}

} // namespace dovetail
