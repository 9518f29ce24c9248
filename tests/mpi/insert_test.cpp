// Meshes that grow: whatever is there first and whatever comes later, the result is the triangulation of all.
#include "dovetail/base/error.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/distributed/insert.hpp"
#include "dovetail/distributed/path_points.hpp"
#include "dovetail/distributed/triangulate.hpp"
#include "dovetail/distributed/validate.hpp"
#include "dovetail/geometry/distributions.hpp"
#include "dovetail/geometry/predicates.hpp"
#include "dovetail/mesh/flip.hpp"
#include "mpi/pipeline_support.hpp"
#include "support/small_sites_families.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>
#include <span>

namespace dovetail::testing {
namespace {

using Points = std::vector<Point>;

bool full() { return std::getenv("DOVETAIL_FULL") != nullptr; }

/// This rank's part of points that come after `before` others: indices from 0, and the z of all points.
PointTable deal_behind(const Communicator &comm, const Points &points, std::size_t before,
                       std::uint64_t seed) {
  PointTable table = deal(comm, points, seed);
  for (std::size_t i = 0; i < table.points.size(); ++i)
    table.attributes[0].values[i] = z_of(table.input_index[i] + static_cast<GlobalIndex>(before));
  return table;
}

struct Shape {
  int slabs;
  AxisChoice axis;
  std::uint64_t seed;
};

std::string text_of(const Shape &shape) {
  return std::to_string(shape.slabs) + " slabs, axis " + (shape.axis == AxisChoice::x ? "x" : "y") +
         ", seed " + std::to_string(shape.seed);
}

DistributedMesh mesh_of(const Communicator &comm, const Points &points, const Shape &shape) {
  TriangulateOptions options;
  options.slabs.slabs = shape.slabs;
  options.slabs.axis = shape.axis;
  return triangulate(comm, deal(comm, points, shape.seed), options);
}

/// What is wrong with a mesh of these points; the same on all ranks, empty if nothing is.
std::string fault_of_mesh(const Communicator &comm, const DistributedMesh &mesh, const Points &all,
                          const Shape &shape) {
  const ValidationReport report = validate(comm, mesh, deal(comm, all, shape.seed + 1));
  if (!report.valid)
    return report.first_violations.empty() ? "invalid" : report.first_violations.front().text;
  const DistributedMesh anew = mesh_of(comm, all, {1, shape.axis, shape.seed + 2});
  if (mesh.checksum != anew.checksum)
    return "another checksum";
  if (mesh.digest.hash != anew.digest.hash || mesh.digest.points != anew.digest.points)
    return "another digest";
  const WholeMesh whole = gather_mesh(comm, mesh);
  std::vector<char> fault;
  if (comm.is_root()) {
    const std::string text = fault_of(whole);
    fault.assign(text.begin(), text.end());
  }
  broadcast_bulk(comm, fault);
  return {fault.begin(), fault.end()};
}

/// `before` is triangulated, `after` is inserted.
void check(const Communicator &comm, const Points &before, const Points &after, const Shape &shape,
           const std::string &what) {
  Points all = before;
  all.insert(all.end(), after.begin(), after.end());
  const GrownMesh grown =
      insert(comm, mesh_of(comm, before, shape), deal_behind(comm, after, before.size(), shape.seed + 3));
  EXPECT_EQ(fault_of_mesh(comm, grown.mesh, all, shape), "")
      << what << ", " << before.size() << " and " << after.size() << " points, " << text_of(shape);
  EXPECT_EQ(grown.statistics.points, static_cast<GlobalIndex>(after.size()));
}

Points points_of(const std::vector<IntegerSite> &sites) {
  Points points;
  for (const IntegerSite &site : sites)
    points.push_back({static_cast<double>(site.x), static_cast<double>(site.y)});
  return points;
}

/// Deals points out to two sets; one of them may stay empty.
std::pair<Points, Points> divide(const Points &points, std::mt19937_64 &random) {
  constexpr double shares[] = {0, 0.1, 0.5, 0.9, 1};
  const double share = shares[random() % 5];
  std::pair<Points, Points> result;
  for (const Point &p : points)
    (std::uniform_real_distribution(0.0, 1.0)(random) < share ? result.first : result.second).push_back(p);
  return result;
}

Shape shape_of(std::uint64_t seed) {
  return {1 + static_cast<int>(seed % 7), seed / 7 % 2 == 0 ? AxisChoice::x : AxisChoice::y, seed};
}

TEST(Insert, SmallAdversarialSets) {
  const Communicator comm = world();
  const int rounds = full() ? 200 : comm.size() <= 3 ? 12 : 4;
  std::uint64_t seed = 1;
  for (int round = 0; round < rounds; ++round)
    for (int family = 0; family < small_sites_family_count; ++family, ++seed) {
      std::mt19937_64 random(seed);
      const auto [before, after] = divide(points_of(small_sites(family, 24, random)), random);
      check(comm, before, after, shape_of(seed), small_sites_family_name(family));
    }
}

/// Whole numbers, so that midpoints and mirror images are exact.
Points scattered(int count, int side, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto coordinate = [&] {
    return 2.0 * static_cast<double>(std::uniform_int_distribution(-side, side)(random));
  };
  Points points(static_cast<std::size_t>(count));
  for (Point &p : points)
    p = {coordinate(), coordinate()};
  return points;
}

/// A path of the mesh, and the lines, alike on all ranks.
struct PathsAndLines {
  Points path_sites;
  std::vector<double> lines;
};

PathsAndLines paths_and_lines(const Communicator &comm, const DistributedMesh &mesh) {
  Points own;
  for (const std::vector<Point> &path : path_points(comm, mesh))
    own.insert(own.end(), path.begin(), path.end());
  return {all_gather_bulk<Point>(comm, own).data, mesh.lines};
}

Point on_line(double line, double along, AxisChoice axis) {
  return axis == AxisChoice::x ? Point{line, along} : Point{along, line};
}

TEST(Insert, WhereItHurts) {
  const Communicator comm = world();
  const int rounds = full() ? 60 : 6;
  for (int round = 0; round < rounds; ++round) {
    const std::uint64_t seed = static_cast<std::uint64_t>(round) + 1;
    const Shape shape{2 + round % 6, round % 2 == 0 ? AxisChoice::x : AxisChoice::y, seed};
    const Points before = scattered(60, round % 3 == 0 ? 6 : 1000, seed);
    const PathsAndLines there = paths_and_lines(comm, mesh_of(comm, before, shape));
    Points far, near_path, on_lines;
    for (const double scale : {-1e3, 1e6, -1e150})
      for (int i = 0; i < 3; ++i)
        far.push_back({scale * (i + 1), scale * (2 - i)});
    for (std::size_t i = 1; i < there.path_sites.size(); ++i) {
      const Point a = there.path_sites[i - 1], b = there.path_sites[i];
      near_path.push_back({(a.x + b.x) / 2, (a.y + b.y) / 2});
    }
    for (const double line : there.lines)
      for (int i = -4; i <= 4; ++i)
        on_lines.push_back(on_line(line, 250.0 * i, shape.axis));
    check(comm, before, far, shape, "far outside");
    check(comm, before, near_path, shape, "in the middle of path edges");
    check(comm, before, on_lines, shape, "on lines");
    check(comm, before, {}, shape, "nothing");
    check(comm, before, before, shape, "all there already");
  }
}

TEST(Insert, IntoAlmostNothing) {
  const Communicator comm = world();
  const Points few[] = {{}, {{1, 1}}, {{0, 0}, {2, 0}}, {{0, 0}, {1, 1}, {2, 2}, {3, 3}}, {{5, 5}, {5, 5}}};
  const Points more[] = {{}, {{-3, 1}}, {{4, 0}, {6, 0}}, {{4, 4}, {-1, -1}}, scattered(30, 5, 1)};
  std::uint64_t seed = 1;
  for (const Points &before : few)
    for (const Points &after : more)
      for (int k = 0; k < 4; ++k, seed += 3)
        check(comm, before, after, shape_of(seed), "almost nothing");
}

// Slabs that only numbers change in, and slabs that many points come to.
TEST(Insert, InOnePlace) {
  const Communicator comm = world();
  const Points before = scattered(2000, 100000, 1);
  for (const int count : {1, 30, 3000}) {
    Points after = scattered(count, 500, 2);
    for (Point &p : after)
      p = {p.x + 150000, p.y};
    const Shape shape{7, AxisChoice::x, 5};
    Points all = before;
    all.insert(all.end(), after.begin(), after.end());
    const GrownMesh grown =
        insert(comm, mesh_of(comm, before, shape), deal_behind(comm, after, before.size(), 8));
    EXPECT_EQ(fault_of_mesh(comm, grown.mesh, all, shape), "") << count;
    EXPECT_LT(grown.statistics.changed_slabs, 7) << count;
    EXPECT_GE(grown.statistics.changed_slabs, 1) << count;
  }
}

// A tenth of the points of every distribution comes later.
TEST(Insert, LargeSets) {
  const Communicator comm = world();
  if (comm.size() != 3 && !full())
    return; // one number of ranks is enough
  for (const Distribution distribution : all_distributions) {
    // Points on a circle are all on every path, and need exact arithmetic.
    const GlobalIndex n = distribution == Distribution::circle && !full() ? 5'000 : 100'000;
    Points all(static_cast<std::size_t>(n));
    generate_points({distribution, n, 5}, 0, all);
    std::shuffle(all.begin(), all.end(), std::mt19937_64(1));
    const auto tenth = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 10 * 9);
    const Shape shape{7, AxisChoice::automatic, 2};
    const GrownMesh grown = insert(comm, mesh_of(comm, Points(all.begin(), tenth), shape),
                                   deal_behind(comm, Points(tenth, all.end()), all.size() / 10 * 9, 4));
    const DistributedMesh anew = mesh_of(comm, all, shape);
    EXPECT_EQ(grown.mesh.checksum, anew.checksum) << distribution_name(distribution);
    EXPECT_EQ(grown.mesh.site_count(), anew.site_count()) << distribution_name(distribution);
    EXPECT_EQ(grown.mesh.triangle_count(), anew.triangle_count()) << distribution_name(distribution);
    EXPECT_EQ(grown.mesh.digest.hash, anew.digest.hash) << distribution_name(distribution);
    if (full()) {
      EXPECT_TRUE(validate(comm, grown.mesh).valid) << distribution_name(distribution);
    }
  }
}

// A mesh that has grown grows on.
TEST(Insert, AgainAndAgain) {
  const Communicator comm = world();
  const Shape shape{5, AxisChoice::y, 3};
  Points all = scattered(40, 30, 1);
  DistributedMesh mesh = mesh_of(comm, all, shape);
  for (std::uint64_t seed = 2; seed < 12; ++seed) {
    const Points more = scattered(15, seed % 2 == 0 ? 40 : 3, seed);
    mesh = insert(comm, std::move(mesh), deal_behind(comm, more, all.size(), seed)).mesh;
    all.insert(all.end(), more.begin(), more.end());
    EXPECT_EQ(fault_of_mesh(comm, mesh, all, shape), "") << seed;
  }
}

/// The input index and z of the representative of the site at a point, from whichever rank has it.
std::pair<GlobalIndex, double> representative(const Communicator &comm, const DistributedMesh &mesh,
                                              Point p) {
  GlobalIndex index = -1;
  double z = -1e9;
  for (const SlabMesh &slab : mesh.slabs)
    for (std::size_t v = 0; v < slab.vertices.points.size(); ++v) // ghosts too
      if (slab.vertices.points[v] == p) {
        EXPECT_TRUE(index == -1 || index == slab.vertices.input_index[v]);
        index = slab.vertices.input_index[v];
        z = slab.vertices.attributes.at(0).values.at(v);
      }
  return {all_reduce_max(comm, index), all_reduce_max(comm, z)};
}

// Site (2, 0) has z = -1.5; points of z = -4 and 5 come to it.
TEST(Insert, WhoRepresentsEqualPoints) {
  const Communicator comm = world();
  const Points before{{0, 0}, {4, 0}, {2, 4}, {2, 0}};
  struct Expected {
    DuplicateRule rule;
    GlobalIndex index;
    double z;
  };
  for (const auto &[rule, index, z] : {Expected{DuplicateRule::first, 3, z_of(3)},
                                       {DuplicateRule::lowest, 4, -4},
                                       {DuplicateRule::highest, 5, 5}}) {
    PointTable points{{}, {}, {{"z", {}}}};
    if (comm.rank() == comm.size() - 1)
      points = {{{2, 0}, {2, 0}}, {0, 1}, {{"z", {-4, 5}}}};
    InsertOptions options;
    options.duplicates = rule;
    const GrownMesh grown =
        insert(comm, mesh_of(comm, before, {3, AxisChoice::x, 1}), std::move(points), options);
    EXPECT_TRUE(validate(comm, grown.mesh).valid);
    EXPECT_EQ(representative(comm, grown.mesh, {2, 0}), std::pair(index, z));
    EXPECT_EQ(grown.statistics.sites, 0);
    EXPECT_EQ(grown.statistics.duplicates, 2);
    GlobalIndex duplicates = all_reduce_sum(comm, static_cast<GlobalIndex>(grown.mesh.duplicates.size()));
    EXPECT_EQ(duplicates, 2);
  }
}

TEST(Insert, AttributesAreMatchedByName) {
  const Communicator comm = world();
  const Points before{{0, 0}, {4, 0}, {2, 4}, {2, 1}};
  PointTable points{{}, {}, {{"class", {}}}};
  if (comm.is_root())
    points = {{{3, 3}, {1, 2}}, {0, 1}, {{"class", {6, 7}}}};
  const GrownMesh grown = insert(comm, mesh_of(comm, before, {2, AxisChoice::x, 1}), std::move(points));
  EXPECT_EQ(grown.statistics.absent_in_points, std::vector<std::string>{"z"});
  EXPECT_EQ(grown.statistics.absent_in_mesh, std::vector<std::string>{"class"});
  for (const SlabMesh &slab : grown.mesh.slabs)
    for (std::size_t v = 0; v < slab.vertices.points.size(); ++v) {
      const GlobalIndex index = slab.vertices.input_index[v];
      ASSERT_EQ(slab.vertices.attributes.size(), 2);
      EXPECT_EQ(slab.vertices.attributes[0].values[v], index < 4 ? z_of(index) : 0);
      const double of_class = slab.vertices.attributes[1].values[v];
      EXPECT_TRUE(index < 4 ? std::isnan(of_class) : of_class == static_cast<double>(index + 2)) << of_class;
    }
  EXPECT_TRUE(validate(comm, grown.mesh).valid);
}

/// Collective. Inserting the points must end in an Error of this kind on all ranks.
void expect_refused(const Communicator &comm, DistributedMesh mesh, const Points &points, ErrorKind kind,
                    DuplicateRule rule = DuplicateRule::first) {
  InsertOptions options;
  options.duplicates = rule;
  try {
    insert(comm, std::move(mesh), deal(comm, points, 1), options);
    ADD_FAILURE() << "nothing was thrown";
  } catch (const Error &error) {
    EXPECT_EQ(error.kind(), kind) << error.what();
  }
}

TEST(Insert, RefusesEqualPointsIfTold) {
  const Communicator comm = world();
  const Points before = scattered(40, 30, 1);
  const DistributedMesh mesh = mesh_of(comm, before, {4, AxisChoice::x, 1});
  expect_refused(comm, mesh, {{1, 1}, before[7]}, ErrorKind::input, DuplicateRule::error);
  expect_refused(comm, mesh, {{1, 1}, {3, 3}, {1, 1}}, ErrorKind::input, DuplicateRule::error);
}

TEST(Insert, RefusesWhatIsNoPoint) {
  const Communicator comm = world();
  expect_refused(comm, mesh_of(comm, scattered(40, 30, 1), {4, AxisChoice::x, 1}), {{1, NAN}},
                 ErrorKind::input);
}

/// Exchanges an edge inside a slab for the other one of its quadrilateral.
void flip_an_edge(SlabMesh &slab) {
  Triangulation &triangles = slab.triangles;
  const auto point = [&](LocalIndex v) { return slab.vertices.points[position(v)]; };
  const auto is_inside = [&](LocalIndex t) {
    return std::ranges::none_of(std::span(triangles.neighbours).subspan(position(half_edge(t, 0)), 3),
                                [](LocalIndex beyond) { return beyond == none; });
  };
  for (HalfEdge h = 0; h < half_edge(triangles.triangle_count(), 0); ++h) {
    const HalfEdge across = twin(triangles, h);
    if (across == none || !is_inside(triangle_of(h)) || !is_inside(triangle_of(across)))
      continue;
    const Point from = point(origin(triangles, h)), to = point(target(triangles, h));
    const Point left = point(apex(triangles, h)), right = point(apex(triangles, across));
    if (orientation(left, from, right) == Sign::positive && orientation(right, to, left) == Sign::positive)
      return flip(triangles, h);
  }
  ADD_FAILURE() << "no edge can be flipped";
}

// The sum that is the checksum has the old triangles in it, so they must be right where all are made anew.
TEST(Insert, RefusesWrongTrianglesThatItMakesAnew) {
  const Communicator comm = world();
  const Points before = scattered(400, 1000, 1);
  DistributedMesh mesh = mesh_of(comm, before, {4, AxisChoice::x, 1});
  for (SlabMesh &slab : mesh.slabs)
    flip_an_edge(slab);
  expect_refused(comm, std::move(mesh), scattered(300, 1000, 2), ErrorKind::input);
}

// Broken meshes end in an error, or in a mesh that validation refuses; but they end, and crash nobody.
TEST(Insert, SurvivesBrokenMeshes) {
  const Communicator comm = world();
  const Points before = scattered(80, 40, 1), after = scattered(60, 60, 2);
  const int rounds = full() ? 2000 : 100;
  std::mt19937_64 random(static_cast<std::uint64_t>(comm.rank()));
  for (int round = 0; round < rounds; ++round) {
    DistributedMesh mesh = mesh_of(comm, before, {4, AxisChoice::x, 1});
    for (SlabMesh &slab : mesh.slabs)
      for (int i = 0; i < 2 && !slab.triangles.corners.empty(); ++i) {
        const std::size_t side = random() % slab.triangles.corners.size();
        const auto vertices = static_cast<std::uint64_t>(slab.vertices.points.size());
        const auto triangles = static_cast<std::uint64_t>(slab.triangles.triangle_count());
        switch (random() % 3) {
        case 0:
          slab.triangles.corners[side] = static_cast<LocalIndex>(random() % vertices);
          break;
        case 1:
          if (slab.triangles.neighbours[side] != none)
            slab.triangles.neighbours[side] = static_cast<LocalIndex>(random() % triangles);
          break;
        default:
          slab.vertices.points[random() % vertices].x += 1;
        }
      }
    try {
      const GrownMesh grown = insert(comm, std::move(mesh), deal(comm, after, 1));
      validate(comm, grown.mesh);
    } catch (const Error &) { // as good an answer
    }
  }
}

} // namespace
} // namespace dovetail::testing
