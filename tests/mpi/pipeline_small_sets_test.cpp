// Thousands of small adversarial sets through the whole pipeline, against the definition of the result.
#include "dovetail/comm/agreement.hpp"
#include "dovetail/distributed/regions.hpp"
#include "dovetail/distributed/stitch.hpp"
#include "dovetail/distributed/triangulate.hpp"
#include "dovetail/distributed/triangulate_region.hpp"
#include "mpi/pipeline_support.hpp"
#include "support/small_sites_families.hpp"

#include <cstdlib>
#include <functional>
#include <gtest/gtest.h>
#include <span>

namespace dovetail::testing {
namespace {

constexpr int family_count = small_sites_family_count + 3;

std::string family_name(int family) {
  static const char *const more[] = {"cross", "hugging a vertical line", "ring"};
  return family < small_sites_family_count ? small_sites_family_name(family)
                                           : more[family - small_sites_family_count];
}

/// Distinct sites in random order.
std::vector<IntegerSite> sites_of_family(int family, int most, std::mt19937_64 &random) {
  if (family < small_sites_family_count)
    return small_sites(family, most, random);
  const auto draw = [&](std::int64_t low, std::int64_t high) {
    return std::uniform_int_distribution<std::int64_t>(low, high)(random);
  };
  std::set<IntegerSite> sites;
  for (std::int64_t i = draw(0, most); i > 0; --i) {
    const std::int64_t along = draw(-40, 40), across = draw(-1, 1);
    if (family == small_sites_family_count)
      sites.insert(i % 2 == 0 ? IntegerSite{along, across} : IntegerSite{across, along});
    else if (family == small_sites_family_count + 1)
      sites.insert({draw(0, 1), along});
    else
      sites.insert({along, draw(0, 1) == 0 ? 45 - std::abs(along) : std::abs(along) - 45});
  }
  std::vector<IntegerSite> result(sites.begin(), sites.end());
  std::shuffle(result.begin(), result.end(), random);
  return result;
}

std::vector<Point> points_of(const std::vector<IntegerSite> &sites) {
  std::vector<Point> points;
  for (const IntegerSite &site : sites)
    points.push_back({static_cast<double>(site.x), static_cast<double>(site.y)});
  return points;
}

std::vector<Corners> expected_corners(const std::vector<IntegerSite> &sites,
                                      const std::vector<Point> &points) {
  std::vector<Corners> result;
  for (const Triple &triple : delaunay_by_definition(sites)) {
    Corners corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const Point p = points[static_cast<std::size_t>(triple[i])];
      corners[i] = {p.x, p.y};
    }
    std::ranges::sort(corners);
    result.push_back(corners);
  }
  std::ranges::sort(result);
  return result;
}

/// F9 for every own slab.
bool counts_foretold(const Region &region, const UnstitchedMesh &local) {
  bool right = true;
  for (std::size_t k = 0; k < local.mesh.slabs.size(); ++k) {
    const SlabMesh &slab = local.mesh.slabs[k];
    const auto own = std::span(slab.vertices.points).first(static_cast<std::size_t>(slab.own_count));
    right = right && triangles_between(own, slab.first_site, region.paths[k], region.paths[k + 1],
                                       local.mesh.axis) == slab.triangles.triangle_count();
  }
  return right;
}

struct Case {
  int family, slabs;
  AxisChoice axis;
  std::uint64_t seed;
};

void check(const Communicator &comm, const Case &c) {
  std::mt19937_64 random(c.seed);
  const std::vector<IntegerSite> sites = sites_of_family(c.family, 24, random);
  const std::vector<Point> points = points_of(sites);
  SlabOptions options;
  options.slabs = c.slabs;
  options.axis = c.axis;
  Region region = split_into_regions(comm, sort_into_slabs(comm, deal(comm, points, c.seed), options));
  const Region copy = region;
  UnstitchedMesh local = triangulate_region(std::move(region));
  const std::string where = family_name(c.family) + ", seed " + std::to_string(c.seed) + ", " +
                            std::to_string(c.slabs) + " slabs, axis " + (c.axis == AxisChoice::x ? "x" : "y");
  EXPECT_TRUE(counts_foretold(copy, local)) << where;
  const DistributedMesh mesh = stitch(comm, std::move(local));
  const WholeMesh whole = gather_mesh(comm, mesh);
  if (!comm.is_root())
    return;
  const std::vector<Corners> expected = expected_corners(sites, points);
  EXPECT_EQ(corners_of(whole), expected) << where;
  EXPECT_EQ(fault_of(whole), "") << where;
  EXPECT_EQ(mesh.triangle_count(), static_cast<GlobalIndex>(expected.size())) << where;
  EXPECT_EQ(mesh.site_count(), static_cast<GlobalIndex>(sites.size())) << where;
}

TEST(PipelineSmallSets, AreTheTriangulationByDefinition) {
  const Communicator comm = world();
  const int rounds = std::getenv("DOVETAIL_FULL") != nullptr ? 300 : comm.size() <= 4 ? 20 : 4;
  const int slab_counts[] = {comm.size(), 7, 16};
  std::uint64_t seed = 1;
  for (int round = 0; round < rounds; ++round)
    for (int family = 0; family < family_count; ++family, ++seed)
      check(comm, {family, slab_counts[seed % 3], seed / 3 % 2 == 0 ? AxisChoice::x : AxisChoice::y, seed});
}

/// Takes a triangle without open sides out of the first slab that has one.
void lose_an_inner_triangle(UnstitchedMesh &local) {
  for (std::size_t k = 0; k < local.mesh.slabs.size(); ++k) {
    Triangulation &triangles = local.mesh.slabs[k].triangles;
    for (LocalIndex t = 0; t < triangles.triangle_count(); ++t) {
      const auto side = triangles.neighbours.begin() + 3 * t;
      if (std::find(side, side + 3, none) != side + 3)
        continue;
      remove_triangles(triangles, std::span(&t, 1));
      local.open_sides[k].clear();
      for (std::size_t s = 0; s < triangles.neighbours.size(); ++s)
        if (triangles.neighbours[s] == none)
          local.open_sides[k].push_back(static_cast<LocalIndex>(s));
      return;
    }
  }
  ADD_FAILURE() << "no slab has an inner triangle";
}

/// Sites in the unit square, split into one region for every rank.
Region uniform_region(const Communicator &comm) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> coordinate(0, 1);
  std::vector<Point> points(static_cast<std::size_t>(100 * comm.size()));
  for (Point &p : points)
    p = {coordinate(random), coordinate(random)};
  SlabOptions options;
  options.slabs = comm.size();
  return split_into_regions(comm, sort_into_slabs(comm, deal(comm, points, 1), options));
}

/// Collective. The work must end with a fault of dovetail on all ranks.
void expect_fault(const std::function<void()> &work) {
  try {
    work();
    ADD_FAILURE() << "nothing was thrown";
  } catch (const Error &error) {
    EXPECT_EQ(error.kind(), ErrorKind::fault) << error.what();
  }
}

// A fault of ours on one rank must never become a file: all ranks refuse the mesh.
TEST(PipelineSmallSets, AMeshThatViolatesEulersRelationIsRefused) {
  const Communicator comm = world();
  UnstitchedMesh local = triangulate_region(uniform_region(comm));
  if (comm.rank() == comm.size() - 1)
    lose_an_inner_triangle(local);
  expect_fault([&] { stitch(comm, std::move(local)); });
}

TEST(PipelineSmallSets, ASlabWithoutTheTrianglesThatItsPathsCallForIsRefused) {
  const Communicator comm = world();
  if (comm.size() == 1)
    return; // no paths
  Region region = uniform_region(comm);
  if (comm.rank() == comm.size() - 1) // its path is not that of its line any more
    region.slabs.lines.back() -= 0.1;
  expect_fault([&] { collectively(comm, [&] { return triangulate_region(std::move(region)); }); });
}

TEST(PipelineSmallSets, AMeshWithoutTrianglesIsRefusedUnlessItsSitesAreCollinear) {
  const Communicator comm = world();
  UnstitchedMesh local = triangulate_region(uniform_region(comm));
  for (std::size_t k = 0; k < local.mesh.slabs.size(); ++k) {
    local.mesh.slabs[k].triangles = {};
    local.open_sides[k].clear();
  }
  expect_fault([&] { stitch(comm, std::move(local)); });
}

} // namespace
} // namespace dovetail::testing
