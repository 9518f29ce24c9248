// Right meshes are found right, with the right counts, whoever made them.
#include "support/mesh_oracle.hpp"

#include "dovetail/comm/collectives.hpp"
#include "dovetail/distributed/triangulate.hpp"
#include "dovetail/distributed/validate.hpp"

#include <boost/mpi/communicator.hpp>
#include <gtest/gtest.h>

using namespace dovetail;

namespace {

Communicator world() { return Communicator::duplicate(boost::mpi::communicator()); }

void expect_valid(const ValidationReport &report) {
  EXPECT_TRUE(report.valid);
  EXPECT_EQ(report.violation_count, 0);
  for (const Violation &violation : report.first_violations)
    ADD_FAILURE() << name_of(violation.kind) << ": " << violation.text;
}

/// Every rank's share of a table, the points dealt out like cards.
PointTable dealt(const PointTable &whole, const Communicator &comm) {
  PointTable share;
  for (const Attribute &attribute : whole.attributes)
    share.attributes.push_back({attribute.name, {}});
  for (std::size_t p = static_cast<std::size_t>(comm.rank()); p < whole.points.size();
       p += static_cast<std::size_t>(comm.size())) {
    share.points.push_back(whole.points[p]);
    share.input_index.push_back(whole.input_index[p]);
    for (std::size_t a = 0; a < share.attributes.size(); ++a)
      share.attributes[a].values.push_back(whole.attributes[a].values[p]);
  }
  return share;
}

std::vector<Point> circle_points() {
  std::vector<Point> points; // integer points on one circle, and its centre
  for (int x = -25; x <= 25; ++x)
    for (int y = -25; y <= 25; ++y)
      if (x * x + y * y == 625)
        points.push_back({static_cast<double>(x), static_cast<double>(y)});
  points.push_back({0, 0});
  return points;
}

std::vector<Point> line_points(double dx, double dy) {
  std::vector<Point> points;
  for (int i = 0; i < 10; ++i)
    points.push_back({dx * (i * 7 % 10) + 0.0, dy * (i * 7 % 10) + 0.0}); // not -0.0
  return points;
}

struct Case {
  const char *name;
  std::vector<Point> points;
};

std::vector<Case> cases() {
  std::vector<Point> far = oracle::random_points(50, 8);
  far.push_back({1e12, 3});
  std::vector<Point> huge = oracle::random_points(40, 9);
  for (Point &p : huge)
    p = {p.x * 1e150, (p.y - 0.5) * 1e150};
  return {{"random", oracle::random_points(200, 1)},
          {"lattice with duplicates", oracle::lattice_points(200, 8, 2)},
          {"circle", circle_points()},
          {"one far away", far},
          {"huge", huge},
          {"vertical", line_points(0, 1)},
          {"horizontal", line_points(1, 0)},
          {"oblique", line_points(1, 2)},
          {"falling", line_points(1, -2)},
          {"all equal", std::vector<Point>(9, Point{2, 3})},
          {"triangle", {{0, 0}, {1, 0}, {0, 1}}},
          {"two", {{0, 0}, {1, 0}}},
          {"one", {{0, 0}}},
          {"none", {}}};
}

} // namespace

TEST(ValidateValid, MeshesOfTheOracle) {
  const Communicator comm = world();
  for (const Case &test : cases())
    for (const Axis axis : {Axis::x, Axis::y})
      for (const int slabs : {1, 4, 11}) {
        SCOPED_TRACE(std::string(test.name) + (axis == Axis::x ? " along x, " : " along y, ") +
                     std::to_string(slabs));
        const PointTable table = oracle::table_of(test.points);
        const DistributedMesh mesh = oracle::make_mesh(table, {slabs, axis, comm.rank(), comm.size()});
        const ValidationReport report = validate(comm, mesh, dealt(table, comm));
        expect_valid(report);
        EXPECT_EQ(report.sites, mesh.site_count());
        EXPECT_EQ(report.triangles, mesh.triangle_count());
        EXPECT_EQ(report.hull_edges, mesh.hull_edges);
        EXPECT_EQ(report.checksum, mesh.checksum);
        EXPECT_EQ(report.duplicates, static_cast<GlobalIndex>(table.points.size()) - mesh.site_count());
        EXPECT_EQ(report.input_points, static_cast<GlobalIndex>(table.points.size()));
        // Every triangle has three sides, and every inner edge two of them.
        EXPECT_EQ(2 * report.inner_edges + report.hull_edges, 3 * report.triangles);
        GlobalIndex border_sides = 0;
        for (const SlabMesh &slab : mesh.slabs)
          border_sides += static_cast<GlobalIndex>(slab.border_sides.size());
        EXPECT_EQ(2 * report.border_edges, all_reduce_sum(comm, border_sides));
      }
}

TEST(ValidateValid, MeshesOfThePipeline) {
  const Communicator comm = world();
  for (const Case &test : cases())
    for (const AxisChoice axis : {AxisChoice::x, AxisChoice::y})
      for (const int slabs : {comm.size() == 7 ? 1 : 7, 2 * comm.size()}) {
        SCOPED_TRACE(std::string(test.name) + (axis == AxisChoice::x ? " along x, " : " along y, ") +
                     std::to_string(slabs));
        const PointTable share = dealt(oracle::table_of(test.points), comm);
        TriangulateOptions options;
        options.slabs.slabs = slabs;
        options.slabs.axis = axis;
        const DistributedMesh mesh = triangulate(comm, PointTable(share), options);
        const ValidationReport report = validate(comm, mesh, share);
        expect_valid(report);
        EXPECT_EQ(report.triangles, mesh.triangle_count());
      }
}

// The same mesh by two ways that share only the predicates and the contract.
TEST(ValidateValid, ThePipelineMakesTheMeshOfTheOracle) {
  const Communicator comm = world();
  for (const Case &test : cases())
    for (const Axis axis : {Axis::x, Axis::y}) {
      SCOPED_TRACE(test.name);
      const PointTable table = oracle::table_of(test.points);
      constexpr int slabs = 8;
      TriangulateOptions options;
      options.slabs.slabs = slabs;
      options.slabs.axis = axis == Axis::x ? AxisChoice::x : AxisChoice::y;
      const DistributedMesh mesh = triangulate(comm, dealt(table, comm), options);
      const DistributedMesh expected = oracle::make_mesh(table, {slabs, axis, comm.rank(), comm.size()});
      EXPECT_EQ(mesh.site_offsets, expected.site_offsets);
      EXPECT_EQ(mesh.triangle_offsets, expected.triangle_offsets);
      EXPECT_EQ(mesh.lines, expected.lines);
      EXPECT_EQ(mesh.hull_edges, expected.hull_edges);
      EXPECT_EQ(mesh.checksum, expected.checksum);
      EXPECT_EQ(mesh.digest.points, expected.digest.points);
      EXPECT_EQ(mesh.digest.hash, expected.digest.hash);
      EXPECT_EQ(mesh.duplicates, expected.duplicates);
      EXPECT_EQ(mesh.slabs.size(), expected.slabs.size());
      for (std::size_t k = 0; k < std::min(mesh.slabs.size(), expected.slabs.size()); ++k) {
        EXPECT_EQ(mesh.slabs[k].ghost_number, expected.slabs[k].ghost_number);
        EXPECT_EQ(mesh.slabs[k].left_path, expected.slabs[k].left_path);
        EXPECT_EQ(mesh.slabs[k].vertices.points, expected.slabs[k].vertices.points);
        EXPECT_EQ(mesh.slabs[k].vertices.input_index, expected.slabs[k].vertices.input_index);
        EXPECT_EQ(mesh.slabs[k].border_sides.size(), expected.slabs[k].border_sides.size());
      }
    }
}
