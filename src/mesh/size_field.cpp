#include "size_field.hpp"

#include "dovetail/geometry/constructions.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace dovetail {
namespace {

template <class Index> constexpr std::size_t index(Index i) { return static_cast<std::size_t>(i); }

/// Of all triangles, the ends of side i of triangle t at 3t + i.
Feature side(const DomainMesh &mesh, std::size_t i) {
  const std::size_t base = i - i % 3;
  return {mesh.triangles.corners[base + (i + 1) % 3], mesh.triangles.corners[base + (i + 2) % 3]};
}

std::vector<Feature> boundary_of(const DomainMesh &mesh, std::span<const LocalIndex> alone) {
  std::vector<Feature> features;
  for (std::size_t i = 0; i < mesh.segment_of_side.size(); ++i)
    if (mesh.segment_of_side[i] != none)
      if (const Feature piece = side(mesh, i); mesh.triangles.neighbours[i] == none || piece.from < piece.to)
        features.push_back(piece);
  for (const LocalIndex v : alone)
    features.push_back({v, v});
  return features;
}

std::vector<double> shortest_edges(const DomainMesh &mesh) {
  std::vector<double> shortest(mesh.vertices.size(), HUGE_VAL);
  for (std::size_t i = 0; i < mesh.triangles.corners.size(); ++i) {
    const auto [from, to] = side(mesh, i);
    const double length = distance(mesh.vertices[index(from)], mesh.vertices[index(to)]);
    for (const LocalIndex end : {from, to})
      shortest[index(end)] = std::min(shortest[index(end)], length);
  }
  return shortest;
}

} // namespace

SizeField::SizeField(const DomainMesh &mesh, std::span<const LocalIndex> alone, double growth)
    : tree_(mesh.vertices, boundary_of(mesh, alone)), growth_(growth),
      least_size_(2 * tree_.leaves, HUGE_VAL) {
  const std::vector<double> shortest = shortest_edges(mesh);
  for (std::size_t i = 0; i < tree_.parts.size(); ++i) {
    const auto [from, to] = tree_.parts[i].feature;
    least_size_[tree_.leaves + i] =
        from == to ? shortest[index(from)] : distance(mesh.vertices[index(from)], mesh.vertices[index(to)]);
  }
  for (std::size_t node = tree_.leaves; node-- > 1;)
    least_size_[node] = std::min(least_size_[2 * node], least_size_[2 * node + 1]);
}

/// Depth first, the nearer child first, only where the sizes and the distance of a box leave a doubt.
bool SizeField::forbids(Point p, double length) const {
  struct Candidate {
    std::size_t node;
    double squared_distance;
  };
  const auto is_open = [&](const Candidate &c) {
    const double slack = (length - least_size_[c.node]) / growth_; // how near is too near
    return slack > 0 && c.squared_distance < slack * slack;
  };
  const auto candidate = [&](std::size_t node) -> Candidate {
    return {node, node < tree_.leaves ? tree_.boxes[node].squared_distance_from(p)
                  : node - tree_.leaves < tree_.parts.size()
                      ? tree_.parts[node - tree_.leaves].squared_distance(p)
                      : HUGE_VAL};
  };
  std::array<Candidate, 64> stack; // two of each level at most
  std::size_t depth = 0;
  if (const Candidate root = candidate(1); is_open(root))
    stack[depth++] = root;
  while (depth > 0) {
    const Candidate next = stack[--depth];
    if (next.node >= tree_.leaves)
      return true;
    Candidate near = candidate(2 * next.node), far = candidate(2 * next.node + 1);
    if (far.squared_distance < near.squared_distance)
      std::swap(near, far);
    for (const Candidate &child : {far, near})
      if (is_open(child))
        stack[depth++] = child;
  }
  return false;
}

} // namespace dovetail
