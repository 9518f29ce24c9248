#include "dovetail/mesh/quality.hpp"

#include <cmath>
#include <numbers>
#include <numeric>

namespace dovetail {
namespace {

constexpr std::size_t index(LocalIndex i) { return static_cast<std::size_t>(i); }
constexpr double radians(double degrees) { return degrees * std::numbers::pi / 180; }

/// The angle between two directions is below 60 degrees.
bool is_small(Displacement a, Displacement b) {
  const double product = dot(a, b);
  return product > 0 && 4 * product * product > squared_length(a) * squared_length(b);
}

LocalIndex other_end(const Segment &segment, LocalIndex end) {
  return segment.from == end ? segment.to : segment.from;
}

} // namespace

AngleBound::AngleBound(double degrees) : degrees_(degrees) {
  const double cosine = std::cos(radians(degrees));
  // Without a bound the comparison is with more than the square of a cosine can be, and off-centers are far.
  four_squared_cosine_ = degrees > 0 ? 4 * cosine * cosine : 5;
  reach_ = degrees > 0 ? 0.5 / std::tan(radians(degrees) / 2) : 1e100;
}

double smallest_angle(Point a, Point b, Point c) {
  const std::array<Point, 3> corner{a, b, c};
  const std::size_t i = squared_sides(a, b, c).shortest();
  const Displacement u = corner[(i + 1) % 3] - corner[i], v = corner[(i + 2) % 3] - corner[i];
  return std::atan2(std::fabs(cross(u, v)), dot(u, v)) * 180 / std::numbers::pi;
}

std::vector<LocalIndex> segments_of_vertices(const DomainMesh &mesh, std::span<const Segment> segments) {
  std::vector<LocalIndex> result(mesh.vertices.size(), none);
  for (std::size_t side = 0; side < mesh.segment_of_side.size(); ++side) {
    const LocalIndex segment = mesh.segment_of_side[side];
    if (segment == none)
      continue;
    const std::size_t base = side / 3 * 3;
    for (const std::size_t i : {(side + 1) % 3, (side + 2) % 3})
      result[index(mesh.triangles.corners[base + i])] = segment;
  }
  for (const Segment &segment : segments)
    for (const LocalIndex end : {segment.from, segment.to})
      result[index(end)] = input_vertex;
  return result;
}

SmallAngles::SmallAngles(std::span<const Point> vertices, std::span<const Segment> segments)
    : segments_(segments.begin(), segments.end()) {
  LocalIndex ends = 0;
  for (const Segment &segment : segments)
    ends = std::max({ends, segment.from + 1, segment.to + 1});
  vertices_.assign(vertices.begin(), vertices.begin() + ends);
  sharp_.assign(index(ends), 0);

  std::vector<std::size_t> first(index(ends) + 1, 0); // of the directions from each vertex
  for (const Segment &segment : segments) {
    ++first[index(segment.from) + 1];
    ++first[index(segment.to) + 1];
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<Displacement> directions(2 * segments.size());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for (const Segment &segment : segments)
    for (const LocalIndex end : {segment.from, segment.to})
      directions[next[index(end)]++] = direction(segment, end);

  for (std::size_t v = 0; v < index(ends); ++v) {
    const std::span around = std::span(directions).subspan(first[v], first[v + 1] - first[v]);
    std::ranges::sort(around, {}, [](Displacement d) { return std::atan2(d.y, d.x); });
    for (std::size_t i = 0; around.size() > 1 && i < around.size(); ++i)
      if (is_small(around[i], around[(i + 1) % around.size()]))
        sharp_[v] = 1;
    sharp_count_ += sharp_[v];
  }
}

Displacement SmallAngles::direction(const Segment &segment, LocalIndex from) const {
  return vertices_[index(other_end(segment, from))] - vertices_[index(from)];
}

/// The vertex where two segments meet at an angle below 60 degrees, or `none`.
LocalIndex SmallAngles::meeting(const Segment &a, const Segment &b) const {
  for (const LocalIndex end : {a.from, a.to})
    if ((end == b.from || end == b.to) && is_small(direction(a, end), direction(b, end)))
      return end;
  return none;
}

bool SmallAngles::on_one_shell(Point p, LocalIndex segment_of_p, Point q, LocalIndex segment_of_q) const {
  if (segment_of_p < 0 || segment_of_q < 0 || segment_of_p == segment_of_q)
    return false;
  const LocalIndex at = meeting(segments_[index(segment_of_p)], segments_[index(segment_of_q)]);
  if (at == none)
    return false;
  constexpr double same = 0.001;
  const double of_p = distance(vertices_[index(at)], p), of_q = distance(vertices_[index(at)], q);
  return std::fabs(of_p - of_q) <= same * std::max(of_p, of_q);
}

bool is_exempt(const DomainMesh &mesh, LocalIndex triangle, const SmallAngles &small_angles,
               std::span<const LocalIndex> segments_of_vertices) {
  const std::size_t base = 3 * index(triangle);
  const auto corner = [&](std::size_t i) { return mesh.triangles.corners[base + i % 3]; };
  const auto point = [&](std::size_t i) { return mesh.vertices[index(corner(i))]; };
  const std::size_t i = squared_sides(point(0), point(1), point(2)).shortest();
  const bool in_corner =
      mesh.segment_of_side[base + (i + 1) % 3] != none && mesh.segment_of_side[base + (i + 2) % 3] != none;
  return in_corner || small_angles.on_one_shell(point(i + 1), segments_of_vertices[index(corner(i + 1))],
                                                point(i + 2), segments_of_vertices[index(corner(i + 2))]);
}

} // namespace dovetail
