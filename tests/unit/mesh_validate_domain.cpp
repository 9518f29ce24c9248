/// Every check of a domain finds the fault that it is for.
#include "dovetail/mesh/validate_domain.hpp"

#include "dovetail/mesh/constrain.hpp"
#include "dovetail/mesh/refine.hpp"
#include "support/domain_families.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <set>

namespace dovetail {
namespace {

constexpr std::size_t index(LocalIndex i) { return static_cast<std::size_t>(i); }

/// A quadrangle with a square hole, refined.
class BrokenDomain : public ::testing::Test {
protected:
  PlanarGraph graph = irregular_ring();
  DomainMesh mesh = refine(constrain(graph).mesh, graph.segments, {.min_angle = 25, .max_area = 0.02}).mesh;

  static PlanarGraph irregular_ring() {
    PlanarGraph ring = testing::nested(2, 0.3);
    ring.vertices[0] = {-1.5, -1};
    return ring;
  }

  DomainReport report(double min_angle = 0) const { return validate_domain(mesh, graph.segments, min_angle); }
  std::set<DomainFaultKind> found(double min_angle = 0) const {
    std::set<DomainFaultKind> kinds;
    const DomainReport whole = report(min_angle);
    for (std::size_t i = 0; i < domain_fault_kinds; ++i)
      if (whole.faults_by_kind[i] > 0)
        kinds.insert(static_cast<DomainFaultKind>(i));
    return kinds;
  }
  std::size_t side_where(auto condition) const {
    std::size_t side = 0;
    while (!condition(side))
      ++side;
    return side;
  }
  std::size_t boundary_side() const {
    return side_where([&](std::size_t side) { return mesh.triangles.neighbours[side] == none; });
  }
  std::size_t inner_side() const {
    return side_where([&](std::size_t side) { return mesh.segment_of_side[side] == none; });
  }
  LocalIndex corner(std::size_t side, std::size_t shift) const {
    return mesh.triangles.corners[side - side % 3 + (side + shift) % 3];
  }
  std::size_t twin(std::size_t side) const {
    std::size_t back = 3 * index(mesh.triangles.neighbours[side]);
    while (corner(back, 1) != corner(side, 2) || corner(back, 2) != corner(side, 1))
      ++back;
    return back;
  }
  /// Without the last triangle, which nobody names any more.
  void drop_last_triangle() {
    const LocalIndex last = mesh.triangles.triangle_count() - 1;
    for (LocalIndex &neighbour : mesh.triangles.neighbours)
      if (neighbour == last)
        neighbour = none;
    const std::size_t sides = 3 * index(last);
    mesh.triangles.corners.resize(sides);
    mesh.triangles.neighbours.resize(sides);
    mesh.segment_of_side.resize(sides);
    mesh.region.resize(index(last));
  }
};

TEST_F(BrokenDomain, NotAtAll) {
  const DomainReport whole = report(25);
  EXPECT_TRUE(whole.valid());
  EXPECT_EQ(whole.components, 1);
  EXPECT_EQ(whole.boundaries, 2);
  EXPECT_EQ(whole.pinched, 0);
  EXPECT_EQ(whole.pieces, whole.boundary_edges);
  EXPECT_NEAR(whole.area, 4.5 - 1.96, 1e-12);
  EXPECT_GE(whole.smallest_angle, 25);
  EXPECT_EQ(3 * mesh.triangles.triangle_count(), 2 * whole.inner_edges + whole.boundary_edges);
}

TEST_F(BrokenDomain, Layout) {
  mesh.region.pop_back();
  EXPECT_EQ(found(), std::set{DomainFaultKind::layout});
}

TEST_F(BrokenDomain, SegmentOutOfRange) {
  mesh.segment_of_side[boundary_side()] = 99;
  EXPECT_EQ(found(), std::set{DomainFaultKind::layout});
}

TEST_F(BrokenDomain, Orientation) {
  std::swap(mesh.triangles.corners[0], mesh.triangles.corners[1]);
  EXPECT_TRUE(found().contains(DomainFaultKind::orientation));
}

TEST_F(BrokenDomain, Adjacency) {
  mesh.triangles.neighbours[inner_side()] = 0;
  EXPECT_TRUE(found().contains(DomainFaultKind::adjacency));
}

TEST_F(BrokenDomain, BoundaryWithoutSegment) {
  mesh.segment_of_side[boundary_side()] = none;
  EXPECT_EQ(found(), (std::set{DomainFaultKind::boundary, DomainFaultKind::chain}));
}

TEST_F(BrokenDomain, SegmentFromOneSideOnly) {
  mesh.segment_of_side[inner_side()] = 0;
  EXPECT_TRUE(found().contains(DomainFaultKind::segment));
}

TEST_F(BrokenDomain, RegionsMeetWithoutSegment) {
  mesh.region[0] = 7;
  EXPECT_EQ(found(), std::set{DomainFaultKind::segment});
}

TEST_F(BrokenDomain, PieceThatDoesNotBelong) {
  const std::size_t side = inner_side();
  mesh.segment_of_side[side] = mesh.segment_of_side[twin(side)] = 0;
  EXPECT_EQ(found(), std::set{DomainFaultKind::chain});
}

TEST_F(BrokenDomain, VertexBesideItsSegment) {
  const std::size_t side = side_where([&](std::size_t s) {
    return mesh.triangles.neighbours[s] == none && index(corner(s, 1)) >= graph.vertices.size();
  });
  Point &p = mesh.vertices[index(corner(side, 1))];
  p = {p.x * (1 + 1e-9), p.y * (1 + 1e-9)};
  EXPECT_TRUE(found().contains(DomainFaultKind::chain));
}

TEST_F(BrokenDomain, NotDelaunay) {
  const auto inside = std::ranges::find(mesh.vertex_markers, 0) - mesh.vertex_markers.begin();
  Point &p = mesh.vertices[static_cast<std::size_t>(inside)];
  const Point place = p;
  bool seen = false;
  for (double shift = 1e-3; shift < 0.2 && !seen; shift *= 1.2) {
    p.x = place.x + shift;
    seen = found() == std::set{DomainFaultKind::delaunay};
  }
  EXPECT_TRUE(seen);
}

TEST_F(BrokenDomain, TriangleMissing) {
  drop_last_triangle();
  EXPECT_TRUE(found().contains(DomainFaultKind::boundary));
}

/// All segments are where they were, and the hole is filled with a second layer of the ring's triangles.
TEST_F(BrokenDomain, TwoLayers) {
  const DomainMesh once = mesh;
  const LocalIndex triangles = once.triangles.triangle_count();
  for (const LocalIndex v : once.triangles.corners)
    mesh.triangles.corners.push_back(v);
  for (const LocalIndex t : once.triangles.neighbours)
    mesh.triangles.neighbours.push_back(t == none ? none : t + triangles);
  mesh.segment_of_side.insert(mesh.segment_of_side.end(), once.segment_of_side.begin(),
                              once.segment_of_side.end());
  mesh.region.insert(mesh.region.end(), once.region.begin(), once.region.end());
  EXPECT_TRUE(found().contains(DomainFaultKind::euler));
}

TEST_F(BrokenDomain, AngleBelowTheBound) { EXPECT_EQ(found(33), std::set{DomainFaultKind::angle}); }

TEST(ValidateDomain, ExceptionsAndPinches) {
  PlanarGraph graph = testing::star(7, 5);
  const DomainReport star = validate_domain(constrain(graph).mesh, graph.segments, 4);
  EXPECT_TRUE(star.valid());
  const DomainReport tips = validate_domain(constrain(graph).mesh, graph.segments, 10);
  EXPECT_TRUE(tips.valid());
  EXPECT_EQ(tips.exempt_triangles, 7);

  PlanarGraph pinched; // two triangles that touch in a vertex
  pinched.vertices = {{0, 0}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}};
  pinched.segments = {{0, 2, 1}, {2, 1, 1}, {1, 0, 1}, {0, 3, 1}, {3, 4, 1}, {4, 0, 1}};
  const DomainReport report = validate_domain(constrain(pinched).mesh, pinched.segments);
  EXPECT_TRUE(report.valid());
  EXPECT_EQ(report.components, 2);
  EXPECT_EQ(report.boundaries, 2);
  EXPECT_EQ(report.pinched, 1);
}

} // namespace
} // namespace dovetail
