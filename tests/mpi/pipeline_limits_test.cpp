// More ranks than anyone tries by hand, and no message longer than a few sites.
#include "dovetail/distributed/regions.hpp"
#include "dovetail/distributed/triangulate.hpp"
#include "dovetail/distributed/validate.hpp"
#include "dovetail/geometry/distributions.hpp"
#include "dovetail/io/mesh.hpp"
#include "mpi/pipeline_support.hpp"
#include "support/temporary_folder.hpp"

#include <gtest/gtest.h>

namespace dovetail::testing {
namespace {

DistributedMesh mesh_of(const Communicator &comm, const std::vector<Point> &points, int slabs) {
  TriangulateOptions options;
  options.slabs.slabs = slabs;
  return triangulate(comm, deal(comm, points, 1), options);
}

/// Everything that travels between ranks passes through, in messages of at most so many bytes.
void expect_the_same(std::int64_t chunk_bytes, const std::vector<Point> &points, int slabs) {
  Communicator comm = world();
  const TemporaryFolder folder(comm);
  const DistributedMesh usual = mesh_of(comm, points, slabs);
  write_mesh(comm, usual, folder.file("usual.vtkhdf"));
  comm.set_chunk_bytes(chunk_bytes);
  const DistributedMesh mesh = mesh_of(comm, points, slabs);
  EXPECT_EQ(mesh.checksum, usual.checksum);
  EXPECT_EQ(mesh.triangle_count(), usual.triangle_count());
  write_mesh(comm, mesh, folder.file("mesh.vtkhdf"));
  EXPECT_EQ(content_of(folder.file("mesh.vtkhdf")) == content_of(folder.file("usual.vtkhdf")), true);
  const ValidationReport report =
      validate(comm, read_mesh(comm, folder.file("mesh.vtkhdf")), deal(comm, points, 1));
  EXPECT_TRUE(report.valid) << (report.first_violations.empty() ? "" : report.first_violations[0].text);
}

TEST(PipelineLimits, TinyMessagesCarryTheSame) {
  const int ranks = world().size();
  std::vector<Point> points(1000);
  generate_points({Distribution::kuzmin, 1000, 1}, 0, points);
  points.insert(points.end(), points.begin(), points.begin() + 100); // duplicates travel as well
  expect_the_same(64, points, ranks);
  points.resize(200);
  expect_the_same(1, points, 2 * ranks + 1);
}

TEST(PipelineLimits, FewerSitesThanRanks) {
  const int ranks = world().size();
  const std::vector<Point> points{{0, 0}, {1, 0}, {0, 1}, {1, 1}, {0.5, 3}};
  for (std::size_t count = 0; count <= points.size(); ++count)
    expect_the_same(64, {points.begin(), points.begin() + static_cast<std::ptrdiff_t>(count)}, ranks);
}

} // namespace
} // namespace dovetail::testing
