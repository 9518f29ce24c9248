// Larger sets of every distribution: the same mesh for every number of ranks and slabs, both axes and every
// order of input, and the mesh that the kernel makes of all points in one process.
#include "dovetail/base/error.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/distributed/triangulate.hpp"
#include "dovetail/geometry/distributions.hpp"
#include "dovetail/mesh/checksum.hpp"
#include "dovetail/mesh/divide_and_conquer.hpp"
#include "mpi/pipeline_support.hpp"

#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>

namespace dovetail::testing {
namespace {

std::vector<Point> points_of(Distribution distribution, GlobalIndex n) {
  std::vector<Point> points(static_cast<std::size_t>(n));
  generate_points({distribution, n, 7}, 0, points);
  return points;
}

struct Expected {
  GlobalIndex sites = 0, triangles = 0;
  std::uint64_t checksum = 0;
};

/// Computed on rank 0 alone.
Expected expected_of(const Communicator &comm, std::vector<Point> points) {
  Expected expected;
  if (comm.is_root()) {
    std::ranges::sort(points, lexicographically_less);
    points.erase(std::unique(points.begin(), points.end()), points.end());
    std::shuffle(points.begin(), points.end(), std::mt19937_64(3));
    const Triangulation whole = delaunay(points);
    expected = {std::ssize(points), whole.triangle_count(),
                checksum_of_sites(points) + checksum_of_triangles(points, whole.corners)};
  }
  broadcast(comm, expected.sites);
  broadcast(comm, expected.triangles);
  broadcast(comm, expected.checksum);
  return expected;
}

DistributedMesh mesh_of(const Communicator &comm, const std::vector<Point> &points, std::uint64_t seed,
                        int slabs, AxisChoice axis) {
  TriangulateOptions options;
  options.slabs.slabs = slabs;
  options.slabs.axis = axis;
  return triangulate(comm, deal(comm, points, seed), options);
}

class EveryDistribution : public ::testing::TestWithParam<Distribution> {};

TEST_P(EveryDistribution, IsTheKernelsMesh) {
  const Communicator comm = world();
  const bool full = std::getenv("DOVETAIL_FULL") != nullptr;
  const GlobalIndex n = full ? 100'000 : GetParam() == Distribution::circle ? 2'000 : 12'000;
  const std::vector<Point> points = points_of(GetParam(), n);
  const Expected expected = expected_of(comm, points);
  std::uint64_t seed = 1;
  for (const int slabs : {comm.size(), 7, 16}) {
    for (const AxisChoice axis : {AxisChoice::x, AxisChoice::y}) {
      if (!full && slabs == 7 && axis == AxisChoice::y)
        continue;
      const DistributedMesh mesh = mesh_of(comm, points, ++seed, slabs, axis);
      EXPECT_EQ(mesh.site_count(), expected.sites);
      EXPECT_EQ(mesh.triangle_count(), expected.triangles);
      EXPECT_EQ(mesh.checksum, expected.checksum) << slabs << " slabs";
      EXPECT_EQ(mesh.digest.points, n);
      const WholeMesh whole = gather_mesh(comm, mesh);
      if (comm.is_root()) {
        EXPECT_EQ(fault_of(whole), "") << slabs << " slabs";
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Pipeline, EveryDistribution, ::testing::ValuesIn(all_distributions),
                         [](const auto &tested) { return std::string(distribution_name(tested.param)); });

TEST(PipelineLargeSets, SlabsAreTheSameForEveryNumberOfRanks) {
  const Communicator comm = world();
  const std::vector<Point> points = points_of(Distribution::kuzmin, 3'000);
  const DistributedMesh many = mesh_of(comm, points, 1, 9, AxisChoice::x);
  const Communicator alone = comm.split(comm.rank());
  const DistributedMesh one = mesh_of(alone, points, 2, 9, AxisChoice::x);
  EXPECT_EQ(many.site_offsets, one.site_offsets);
  EXPECT_EQ(many.triangle_offsets, one.triangle_offsets);
  EXPECT_EQ(many.lines, one.lines);
  EXPECT_EQ(many.hull_edges, one.hull_edges);
  for (std::size_t k = 0; k < many.slabs.size(); ++k) {
    const SlabMesh &a = many.slabs[k], &b = one.slabs[k + static_cast<std::size_t>(many.first_slab)];
    EXPECT_EQ(a.own_count, b.own_count);
    EXPECT_EQ(a.vertices.points, b.vertices.points);
    EXPECT_EQ(a.vertices.input_index, b.vertices.input_index);
    EXPECT_EQ(a.vertices.attributes.at(0).values, b.vertices.attributes.at(0).values);
    EXPECT_EQ(a.ghost_number, b.ghost_number);
    EXPECT_EQ(a.triangles.corners, b.triangles.corners);
    EXPECT_EQ(a.triangles.neighbours, b.triangles.neighbours);
    EXPECT_EQ(a.left_path, b.left_path);
    EXPECT_TRUE(std::ranges::equal(a.border_sides, b.border_sides, [](BorderSide p, BorderSide q) {
      return p.side == q.side && p.neighbour == q.neighbour;
    }));
  }
}

TEST(PipelineLargeSets, RanksHoldTheirOwnTwoPathsAndFewCandidates) {
  const Communicator comm = world();
  const GlobalIndex n = 40'000;
  const double root = std::sqrt(static_cast<double>(n));
  const DistributedMesh mesh =
      mesh_of(comm, points_of(Distribution::uniform, n), 5, comm.size(), AxisChoice::x);
  const MeshStatistics &statistics = mesh.statistics;
  EXPECT_LE(statistics.own_sites_max, n / comm.size() + 1);
  EXPECT_LE(static_cast<double>(statistics.longest_path), 1.6 * root);
  EXPECT_LE(statistics.path_sites_max, 2 * statistics.longest_path);
  // The approximate path, and what it lets through of all other ranks together.
  EXPECT_LE(static_cast<double>(statistics.candidate_sites_max), 3 * root);
  if (comm.size() > 1) {
    EXPECT_GE(statistics.candidate_sites_max, statistics.longest_path / 2);
    EXPECT_GE(statistics.path_sites, (comm.size() - 1) * (statistics.longest_path / 4));
  }
}

TEST(PipelineLargeSets, SitesThatHugAVerticalLineAreCutAlongY) {
  const Communicator comm = world();
  const std::vector<Point> points = points_of(Distribution::line, 20'000);
  const DistributedMesh chosen = mesh_of(comm, points, 1, 8, AxisChoice::automatic);
  const DistributedMesh other = mesh_of(comm, points, 1, 8, AxisChoice::x);
  EXPECT_EQ(chosen.axis, Axis::y);
  EXPECT_EQ(chosen.checksum, other.checksum);
  EXPECT_LE(10 * chosen.statistics.path_sites, other.statistics.path_sites);
}

TEST(PipelineLargeSets, ReportsItsPhasesAndProgress) {
  const Communicator comm = world();
  PhaseLog log(comm);
  TriangulateOptions options;
  double last = 0;
  options.phases = &log;
  options.slabs.slabs = 2 * comm.size();
  options.slabs.progress = [&](std::string_view stage, double fraction) {
    last = stage == "triangulate" ? fraction : last;
  };
  triangulate(comm, deal(comm, points_of(Distribution::normal, 5'000), 1), options);
  std::vector<std::string> names;
  for (const Phase &phase : log.phases())
    names.push_back(phase.name);
  EXPECT_EQ(names, (std::vector<std::string>{"sort", "split", "triangulate", "stitch"}));
  EXPECT_EQ(last, 1.0);
}

TEST(PipelineLargeSets, AnInterruptionOfOneRankIsThrownByAll) {
  const Communicator comm = world();
  struct Place {
    std::string_view stage;
    double fraction;
  };
  for (const Place place : {Place{"sort", 0}, Place{"split", 0}, Place{"triangulate", 0},
                            Place{"triangulate", 1}, Place{"stitch", 0}}) {
    TriangulateOptions options;
    options.slabs.slabs = comm.size();
    options.slabs.progress = [&](std::string_view stage, double fraction) {
      if (stage == place.stage && fraction >= place.fraction && comm.rank() == comm.size() - 1)
        throw Error({ErrorKind::resource, "run", "", "interrupted", ""});
    };
    EXPECT_THROW(triangulate(comm, deal(comm, points_of(Distribution::normal, 500), 1), options), Error)
        << place.stage << " at " << place.fraction;
  }
}

} // namespace
} // namespace dovetail::testing
