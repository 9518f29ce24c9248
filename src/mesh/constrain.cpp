#include "dovetail/mesh/constrain.hpp"

#include "carve.hpp"
#include "dovetail/base/error.hpp"
#include "dovetail/mesh/divide_and_conquer.hpp"
#include "faces.hpp"
#include "segment_insertion.hpp"

#include <algorithm>
#include <fmt/core.h>
#include <random>

namespace dovetail {
namespace {

constexpr std::size_t index(LocalIndex i) { return static_cast<std::size_t>(i); }

void check_segments(const PlanarGraph &graph) {
  const auto vertices = static_cast<LocalIndex>(graph.vertices.size());
  for (std::size_t i = 0; i < graph.segments.size(); ++i) {
    const auto [from, to, marker] = graph.segments[i];
    if (std::min(from, to) < 0 || std::max(from, to) >= vertices || from == to)
      throw Error({ErrorKind::input, "segments", fmt::format("segment {}", i),
                   fmt::format("it joins vertices {} and {} of {}", from, to, vertices),
                   "a segment joins two different vertices, counted from 0"});
  }
}

/// Most segments of a dense graph are edges already. The others are inserted in random order, which keeps the
/// sum of what they cross small (Agarwal, Arge, Yi, I/O-efficient construction of constrained Delaunay
/// triangulations, 2005).
void insert_segments(const PlanarGraph &graph, Faces &faces) {
  if (graph.segments.empty())
    return;
  SegmentInsertion insertion(graph.vertices, faces);
  std::vector<LocalIndex> missing;
  for (std::size_t i = 0; i < graph.segments.size(); ++i)
    if (!insertion.insert_edge(graph.segments[i], static_cast<LocalIndex>(i)))
      missing.push_back(static_cast<LocalIndex>(i));
  std::mt19937_64 random(missing.size());
  for (std::size_t i = missing.size(); i > 1; --i)
    std::swap(missing[i - 1], missing[random() % i]);
  for (const LocalIndex i : missing)
    insertion.insert(graph.segments[index(i)], i);
}

/// Sides of the hull that are no segments become some.
std::vector<Segment> make_hull_segments(std::size_t first, std::int32_t marker, Faces &faces) {
  std::vector<Segment> made;
  for (LocalIndex t = 0; t < faces.count(); ++t)
    for (HalfEdge h = 4 * t; h < 4 * t + 3; ++h)
      if (faces.twin(h) == none && !faces.is_segment(h)) {
        faces.set_segment(h, static_cast<LocalIndex>(first + made.size()));
        made.push_back({faces.from(h), faces.to(h), marker});
      }
  return made;
}

std::vector<std::int32_t> markers_of_vertices(const PlanarGraph &graph,
                                              const std::vector<Segment> &hull_segments) {
  std::vector<std::int32_t> markers = graph.vertex_markers;
  markers.resize(graph.vertices.size(), 0);
  for (const std::vector<Segment> *segments : {&graph.segments, &hull_segments})
    for (const Segment &segment : *segments)
      for (const LocalIndex end : {segment.from, segment.to})
        if (markers[index(end)] == 0)
          markers[index(end)] = segment.marker;
  return markers;
}

} // namespace

Constrained constrain(const PlanarGraph &graph, const ConstrainOptions &options) {
  check_segments(graph);
  Constrained result;
  const Triangulation delaunay_mesh = delaunay(graph.vertices);
  Faces faces = faces_of(delaunay_mesh);
  if (faces.count() > 0) {
    insert_segments(graph, faces);
    if (options.outline == Outline::convex_hull)
      result.hull_segments = make_hull_segments(graph.segments.size(), options.hull_marker, faces);
    else
      mark_outside(graph, faces);
  }
  result.stray_holes = mark_holes(graph.vertices, graph.holes, faces);
  result.stray_regions = number_regions(graph.vertices, graph.regions, faces);
  result.mesh.vertices = graph.vertices;
  result.mesh.vertex_markers = markers_of_vertices(graph, result.hull_segments);
  collect_faces(faces, result.mesh);
  result.nothing_left = faces.count() > 0 && result.mesh.triangles.triangle_count() == 0;
  return result;
}

} // namespace dovetail
