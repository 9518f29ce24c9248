// What programs ask of a distributed mesh: who owns what, who is next to whom, values on owners and ghosts;
// and what they may hand over to get one.
#include "dovetail/distributed/ghosts.hpp"
#include "dovetail/distributed/number_points.hpp"
#include "dovetail/distributed/ownership.hpp"
#include "dovetail/distributed/triangulate.hpp"
#include "mpi/pipeline_support.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <set>

namespace dovetail::testing {
namespace {

std::vector<Point> scattered(std::size_t count) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Point> points(count);
  for (Point &point : points)
    point = {unit(random), unit(random)};
  return points;
}

/// A mesh of many slabs, few of which reach far: ghosts then come from several ranks away.
DistributedMesh mesh_of(const Communicator &comm, std::size_t sites, int slabs) {
  TriangulateOptions options;
  options.slabs.slabs = slabs;
  return triangulate(comm, deal(comm, scattered(sites), 1), options);
}

/// What every rank says it owns, gathered: the rank of site (or triangle) n at n.
std::vector<int> told_by_owners(const Communicator &comm, const DistributedMesh &mesh, bool of_triangles) {
  std::vector<int> own;
  for (const SlabMesh &slab : mesh.slabs)
    own.resize(own.size() +
                   static_cast<std::size_t>(of_triangles ? slab.triangles.triangle_count() : slab.own_count),
               comm.rank());
  return all_gather_bulk<int>(comm, own).data;
}

class MeshAccess : public ::testing::TestWithParam<std::pair<std::size_t, int>> {
protected:
  const Communicator comm_ = world();
  const DistributedMesh mesh_ = mesh_of(comm_, GetParam().first, GetParam().second);
};

TEST_P(MeshAccess, OwnersAreThoseWhoOwn) {
  const std::vector<int> sites = told_by_owners(comm_, mesh_, false);
  EXPECT_EQ(std::ssize(sites), mesh_.site_count());
  for (std::size_t n = 0; n < sites.size(); ++n)
    EXPECT_EQ(rank_of_site(mesh_, static_cast<GlobalIndex>(n), comm_.size()), sites[n]) << n;
  const std::vector<int> triangles = told_by_owners(comm_, mesh_, true);
  EXPECT_EQ(std::ssize(triangles), mesh_.triangle_count());
  for (std::size_t n = 0; n < triangles.size(); ++n)
    EXPECT_EQ(rank_of_triangle(mesh_, static_cast<GlobalIndex>(n), comm_.size()), triangles[n]) << n;
}

TEST_P(MeshAccess, NeighboursAreThoseOfTheWholeMesh) {
  const WholeMesh whole = gather_mesh(comm_, mesh_); // on rank 0
  std::vector<GlobalIndex> neighbours;
  for (const WholeMesh::Triangle &triangle : whole.triangles)
    neighbours.insert(neighbours.end(), triangle.neighbour.begin(), triangle.neighbour.end());
  broadcast_bulk(comm_, neighbours);

  const std::vector<int> owner = told_by_owners(comm_, mesh_, true);
  std::set<int> expected;
  for (std::size_t side = 0; side < neighbours.size(); ++side)
    if (neighbours[side] != none && owner[side / 3] == comm_.rank())
      expected.insert(owner[static_cast<std::size_t>(neighbours[side])]);
  expected.erase(comm_.rank());
  const std::vector<int> found = neighbour_ranks(mesh_, comm_.rank(), comm_.size());
  EXPECT_EQ(found, std::vector<int>(expected.begin(), expected.end()));

  for (const SlabMesh &slab : mesh_.slabs)
    for (LocalIndex side = 0; side < 3 * slab.triangles.triangle_count(); ++side)
      EXPECT_EQ(number_of_neighbour(slab, side),
                neighbours[static_cast<std::size_t>(3 * slab.first_triangle + side)]);
}

TEST_P(MeshAccess, RankSitesHoldEveryVertexOnce) {
  const RankSites sites = rank_sites(comm_, mesh_);
  std::set<GlobalIndex> numbers;
  for (const SlabMesh &slab : mesh_.slabs) {
    const std::vector<std::size_t> positions = positions_of_vertices(sites, slab);
    EXPECT_EQ(positions.size(), slab.vertices.points.size());
    for (std::size_t v = 0; v < positions.size(); ++v) {
      const GlobalIndex number = number_of_vertex(slab, static_cast<LocalIndex>(v));
      numbers.insert(number);
      const std::size_t p = positions[v];
      EXPECT_EQ(number, p < sites.own_count ? sites.first_site + static_cast<GlobalIndex>(p)
                                            : sites.ghosts.at(p - sites.own_count));
    }
  }
  EXPECT_EQ(numbers.size(), sites.size());
}

TEST_P(MeshAccess, GhostsGetTheValuesOfTheirOwners) {
  const RankSites sites = rank_sites(comm_, mesh_);
  std::vector<GlobalIndex> values(sites.size(), -1);
  for (std::size_t p = 0; p < sites.own_count; ++p)
    values[p] = 3 * (sites.first_site + static_cast<GlobalIndex>(p)) + 1;
  update_ghosts<GlobalIndex>(comm_, sites, values);
  for (std::size_t p = 0; p < sites.own_count; ++p)
    EXPECT_EQ(values[p], 3 * (sites.first_site + static_cast<GlobalIndex>(p)) + 1);
  for (std::size_t g = 0; g < sites.ghosts.size(); ++g)
    EXPECT_EQ(values[sites.own_count + g], 3 * sites.ghosts[g] + 1);
}

TEST_P(MeshAccess, OwnersSumUpWhatTrianglesAdd) {
  const RankSites sites = rank_sites(comm_, mesh_);
  std::vector<std::int64_t> triangles_around(sites.size());
  for (const SlabMesh &slab : mesh_.slabs) {
    const auto positions = positions_of_vertices(sites, slab);
    for (const LocalIndex corner : slab.triangles.corners)
      ++triangles_around[positions[static_cast<std::size_t>(corner)]];
  }
  add_ghosts<std::int64_t>(comm_, sites, triangles_around);

  // The same from the whole mesh, at one place.
  std::vector<std::int64_t> expected(static_cast<std::size_t>(mesh_.site_count()));
  for (const WholeMesh::Triangle &triangle : gather_mesh(comm_, mesh_).triangles)
    for (const GlobalIndex corner : triangle.corner)
      ++expected[static_cast<std::size_t>(corner)];
  broadcast_bulk(comm_, expected);
  for (std::size_t p = 0; p < sites.own_count; ++p)
    EXPECT_EQ(triangles_around[p], expected[static_cast<std::size_t>(sites.first_site) + p]);
}

INSTANTIATE_TEST_SUITE_P(SitesAndSlabs, MeshAccess,
                         ::testing::Values(std::pair<std::size_t, int>{0, 0},
                                           std::pair<std::size_t, int>{2, 3},
                                           std::pair<std::size_t, int>{40, 17},
                                           std::pair<std::size_t, int>{500, 2},
                                           std::pair<std::size_t, int>{500, 11}));

TEST(RankOfSlab, InvertsFirstSlabOfRank) {
  for (int slabs = 1; slabs < 40; ++slabs)
    for (int ranks = 1; ranks < 40; ++ranks)
      for (int rank = 0; rank < ranks; ++rank)
        for (int s = first_slab_of_rank(slabs, rank, ranks); s < first_slab_of_rank(slabs, rank + 1, ranks);
             ++s)
          EXPECT_EQ(rank_of_slab(slabs, s, ranks), rank) << slabs << ' ' << s << ' ' << ranks;
}

TEST(PointsInMemory, AreNumberedByRankAndGiveTheSameMesh) {
  const Communicator comm = world();
  const std::vector<Point> all = scattered(300);
  // Rank r has the points from r * r on, so the shares are uneven; the last rank has the rest.
  const auto begin_of = [&](int rank) {
    return rank == comm.size() ? all.size() : static_cast<std::size_t>(rank * rank);
  };
  const std::size_t begin = begin_of(comm.rank());
  const std::span<const Point> own(all.data() + begin, begin_of(comm.rank() + 1) - begin);
  const DistributedMesh mesh = triangulate(comm, own);
  EXPECT_EQ(mesh.checksum, triangulate(comm, deal(comm, all, 3)).checksum);
  EXPECT_EQ(mesh.site_count(), 300);
  for (const SlabMesh &slab : mesh.slabs)
    for (std::size_t v = 0; v < slab.vertices.points.size(); ++v)
      EXPECT_EQ(slab.vertices.points[v], all[static_cast<std::size_t>(slab.vertices.input_index[v])]);
}

TEST(PointsInMemory, MinusZeroIsZero) {
  const Communicator comm = world();
  const std::vector<Point> points{{-0.0, 1}, {0.0, 1}, {1, -0.0}, {1, 0.0}, {0, 0}, {-0.0, -0.0}};
  const DistributedMesh mesh = triangulate(comm, points); // on every rank, so all are there several times
  EXPECT_EQ(mesh.site_count(), 3);
  EXPECT_EQ(mesh.triangle_count(), 1);
  for (const SlabMesh &slab : mesh.slabs)
    for (const Point point : slab.vertices.points)
      EXPECT_FALSE(std::signbit(point.x) || std::signbit(point.y));
}

/// The same problem on all ranks, caused by what the last rank alone does to its table.
template <class Spoil> Problem problem_after(Spoil spoil) {
  const Communicator comm = world();
  PointTable table = deal(comm, scattered(100), 5);
  if (comm.rank() == comm.size() - 1)
    spoil(table);
  std::optional<Problem> problem;
  try {
    triangulate(comm, std::move(table));
  } catch (const Error &error) {
    problem = error.problem();
  }
  EXPECT_TRUE(problem.has_value());
  Problem result = problem.value_or(Problem{});
  std::string first = result.place + result.what;
  broadcast(comm, first);
  EXPECT_EQ(first, result.place + result.what);
  EXPECT_NE(result.place.find("rank " + std::to_string(comm.size() - 1)), std::string::npos) << result.place;
  return result;
}

TEST(PointsInMemory, FaultsOfOneRankAreErrorsOnAll) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(problem_after([&](PointTable &t) { t.points.back().x = bad; }).kind, ErrorKind::input);
    EXPECT_EQ(problem_after([&](PointTable &t) { t.points.front().y = bad; }).kind, ErrorKind::input);
    EXPECT_EQ(problem_after([&](PointTable &t) { t.attributes[0].values[1] = bad; }).kind, ErrorKind::input);
  }
  EXPECT_EQ(problem_after([](PointTable &t) { t.input_index.pop_back(); }).kind, ErrorKind::usage);
  EXPECT_EQ(problem_after([](PointTable &t) { t.attributes[0].values.push_back(0); }).kind, ErrorKind::usage);
  if (world().size() > 1) { // on one rank there is nothing to differ from
    EXPECT_EQ(problem_after([](PointTable &t) { t.attributes.clear(); }).kind, ErrorKind::usage);
    EXPECT_EQ(problem_after([](PointTable &t) { t.attributes[0].name = "height"; }).kind, ErrorKind::usage);
  }
}

} // namespace
} // namespace dovetail::testing
