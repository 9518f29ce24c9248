// Meshes broken in one way each are found broken, and the violation has the right name.
#include "support/mesh_oracle.hpp"

#include "dovetail/comm/collectives.hpp"
#include "dovetail/distributed/validate.hpp"
#include "dovetail/mesh/checksum.hpp"

#include <boost/mpi/communicator.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <set>

using namespace dovetail;

namespace {

template <class T> std::size_t at(T index) { return static_cast<std::size_t>(index); }

using Triangles = std::vector<std::array<LocalIndex, 3>>;
using Kind = ViolationKind;

Communicator world() { return Communicator::duplicate(boost::mpi::communicator()); }

constexpr int slabs = 5;

PointTable test_points() { return oracle::table_of(oracle::lattice_points(150, 9, 21)); }

DistributedMesh good_mesh(const Communicator &comm) {
  return oracle::make_mesh(test_points(), {slabs, Axis::x, comm.rank(), comm.size()});
}

std::string text_of(const ValidationReport &report) {
  std::string text = std::to_string(report.violation_count) + " violations";
  for (const Violation &violation : report.first_violations)
    text += "\n  " + std::string(name_of(violation.kind)) + ": " + violation.text;
  return text;
}

/// The report must say "broken", with this kind among its kinds, and, if `only`, no other.
void expect_found(const ValidationReport &report, Kind kind, bool only = false) {
  EXPECT_FALSE(report.valid);
  EXPECT_GT(report.violations_by_kind[at(kind)], 0) << "no " << name_of(kind) << " among " << text_of(report);
  bool named = false;
  for (const Violation &violation : report.first_violations) {
    named = named || violation.kind == kind;
    EXPECT_FALSE(violation.text.empty());
  }
  EXPECT_TRUE(named);
  if (only) {
    EXPECT_EQ(report.violations_by_kind[at(kind)], report.violation_count) << text_of(report);
  }
}

using Change = std::function<void(DistributedMesh &)>;

/// Breaks what all ranks hold alike.
void expect_common(Kind kind, const Change &change, bool only = false) {
  const Communicator comm = world();
  DistributedMesh mesh = good_mesh(comm);
  EXPECT_TRUE(validate(comm, mesh).valid);
  change(mesh);
  expect_found(validate(comm, mesh), kind, only);
}

using SlabChange = std::function<void(SlabMesh &)>;

/// Breaks one slab, on the rank that has it; each slab that can be broken so (`change` makes a difference or
/// throws nothing), one after another.
void expect_in_slab(Kind kind, int s, const SlabChange &change, bool only = false) {
  expect_common(
      kind,
      [&](DistributedMesh &mesh) {
        if (s >= mesh.first_slab && s < mesh.first_slab + static_cast<int>(mesh.slabs.size()))
          change(mesh.slabs[at(s - mesh.first_slab)]);
      },
      only);
}

/// First side of a slab with a neighbour inside it.
std::size_t inner_side(const SlabMesh &slab) {
  std::size_t side = 0;
  while (slab.triangles.neighbours[side] == none)
    ++side;
  return side;
}

} // namespace

TEST(ValidateBroken, CornersSwapped) {
  for (int s = 0; s < slabs; ++s)
    expect_in_slab(Kind::orientation, s,
                   [](SlabMesh &slab) { std::swap(slab.triangles.corners[3], slab.triangles.corners[4]); });
}

TEST(ValidateBroken, CornerTwice) {
  expect_in_slab(Kind::orientation, 2,
                 [](SlabMesh &slab) { slab.triangles.corners[3] = slab.triangles.corners[4]; });
}

TEST(ValidateBroken, WrongNeighbour) {
  for (int s = 0; s < slabs; ++s)
    expect_in_slab(
        Kind::adjacency, s,
        [](SlabMesh &slab) {
          LocalIndex &neighbour = slab.triangles.neighbours[inner_side(slab)];
          neighbour = neighbour == 0 ? slab.triangles.triangle_count() - 1 : neighbour - 1;
        },
        true);
}

TEST(ValidateBroken, WrongNeighbourAcrossABorder) {
  const GlobalIndex last = good_mesh(world()).triangle_count() - 1;
  expect_in_slab(
      Kind::adjacency, 1, [last](SlabMesh &slab) { slab.border_sides.front().neighbour = last; }, true);
}

TEST(ValidateBroken, BorderSidesSwapped) {
  expect_in_slab(Kind::adjacency, 2, [](SlabMesh &slab) {
    std::swap(slab.border_sides.front().neighbour, slab.border_sides.back().neighbour);
  });
}

// One slab believes it ends in the hull where its neighbour goes on.
TEST(ValidateBroken, BorderSideForgotten) {
  const auto forget = [](SlabMesh &slab) { slab.border_sides.erase(slab.border_sides.begin()); };
  expect_in_slab(Kind::adjacency, 1, forget);
  expect_in_slab(Kind::hull, 1, forget);
  expect_in_slab(Kind::euler, 1, forget);
}

TEST(ValidateBroken, InnerSideForgotten) {
  expect_in_slab(Kind::hull, 3, [](SlabMesh &slab) { slab.triangles.neighbours[inner_side(slab)] = none; });
}

TEST(ValidateBroken, LayoutOfASlab) {
  const auto expect = [](const SlabChange &change) { expect_in_slab(Kind::layout, 2, change, true); };
  expect([](SlabMesh &slab) {
    slab.triangles.corners[5] = static_cast<LocalIndex>(slab.vertices.points.size());
  });
  expect([](SlabMesh &slab) { slab.triangles.corners[5] = -1; });
  expect([](SlabMesh &slab) { slab.triangles.neighbours[5] = slab.triangles.triangle_count(); });
  expect([](SlabMesh &slab) { slab.triangles.neighbours[5] = -2; });
  expect([](SlabMesh &slab) { slab.triangles.corners.pop_back(); });
  expect([](SlabMesh &slab) { slab.triangles.neighbours.pop_back(); });
  expect([](SlabMesh &slab) { slab.border_sides[0].neighbour = -5; });
  expect([](SlabMesh &slab) { slab.border_sides[0].neighbour = slab.first_triangle; });
  expect([](SlabMesh &slab) { slab.border_sides[0].neighbour = 1 << 20; });
  expect([](SlabMesh &slab) { slab.border_sides[0].side = 1 << 20; });
  expect([](SlabMesh &slab) { std::swap(slab.border_sides[0], slab.border_sides[1]); });
  expect([](SlabMesh &slab) { ++slab.first_site; });
  expect([](SlabMesh &slab) { --slab.own_count; });
  expect([](SlabMesh &slab) { ++slab.first_triangle; });
  expect([](SlabMesh &slab) { slab.ghost_number.pop_back(); });
  expect([](SlabMesh &slab) { slab.ghost_number.back() = 1 << 20; });
  expect([](SlabMesh &slab) { slab.ghost_number.back() = slab.first_site; });
  expect([](SlabMesh &slab) { std::swap(slab.ghost_number[0], slab.ghost_number[1]); });
  expect([](SlabMesh &slab) { slab.vertices.input_index.pop_back(); });
  expect([](SlabMesh &slab) { slab.vertices.attributes[1].values.pop_back(); });
  expect([](SlabMesh &slab) { slab.vertices.attributes[1].name = "other"; });
  expect([](SlabMesh &slab) { slab.left_path[0] = -1; });
  // A triangle less, with all that depends on it.
  expect([](SlabMesh &slab) {
    slab.triangles.corners.resize(slab.triangles.corners.size() - 3);
    slab.triangles.neighbours.resize(slab.triangles.neighbours.size() - 3);
    for (LocalIndex &neighbour : slab.triangles.neighbours)
      if (neighbour == slab.triangles.triangle_count())
        neighbour = none;
    while (at(slab.border_sides.back().side) >= slab.triangles.neighbours.size())
      slab.border_sides.pop_back();
  });
}

TEST(ValidateBroken, LayoutOfTheWhole) {
  const auto expect = [](const Change &change) { expect_common(Kind::layout, change, true); };
  expect([](DistributedMesh &mesh) { mesh.lines.pop_back(); });
  expect([](DistributedMesh &mesh) { mesh.site_offsets[0] = 1; });
  expect([](DistributedMesh &mesh) { std::swap(mesh.site_offsets[1], mesh.site_offsets[2]); });
  expect([](DistributedMesh &mesh) { mesh.triangle_offsets.pop_back(); });
  expect([](DistributedMesh &mesh) { mesh.site_offsets.clear(); });
  expect([](DistributedMesh &mesh) { ++mesh.first_slab; });
  expect([](DistributedMesh &mesh) {
    if (!mesh.slabs.empty())
      mesh.slabs.pop_back();
  });
}

TEST(ValidateBroken, RanksDisagree) {
  const Communicator comm = world();
  if (comm.size() == 1)
    return;
  DistributedMesh mesh = good_mesh(comm);
  if (comm.rank() == comm.size() - 1)
    ++mesh.hull_edges;
  expect_found(validate(comm, mesh), Kind::layout, true);
}

TEST(ValidateBroken, CoordinatesThatAreNone) {
  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    expect_in_slab(
        Kind::coordinate, 1, [value](SlabMesh &slab) { slab.vertices.points[0].y = value; }, true);
    expect_in_slab(
        Kind::coordinate, 4, [value](SlabMesh &slab) { slab.vertices.points.back().x = value; }, true);
  }
  // The first site is at (0, y): the value stays, the bits do not.
  expect_in_slab(Kind::coordinate, 0, [](SlabMesh &slab) { slab.vertices.points[0].x = -0.0; });
}

TEST(ValidateBroken, OwnSiteMovedByAnUlp) {
  for (int s = 0; s < slabs; ++s) {
    const auto move = [](SlabMesh &slab) {
      Point &p = slab.vertices.points[at(slab.own_count / 2)];
      p.y = std::nextafter(p.y, 100.0);
    };
    expect_in_slab(Kind::checksum, s, move);
    expect_in_slab(Kind::digest, s, move);
  }
}

TEST(ValidateBroken, GhostsThatDiffer) {
  const auto expect = [](const SlabChange &change) { expect_in_slab(Kind::ghost, 2, change); };
  expect([](SlabMesh &slab) {
    Point &p = slab.vertices.points.back();
    p.y = std::nextafter(p.y, 100.0);
  });
  expect([](SlabMesh &slab) { ++slab.vertices.input_index.back(); });
  expect([](SlabMesh &slab) { slab.vertices.attributes[0].values.back() += 1; });
  expect([](SlabMesh &slab) { slab.vertices.attributes[1].values.back() += 1; });
}

// An owner's column differs from what its ghosts elsewhere say.
TEST(ValidateBroken, OwnersThatDiffer) {
  expect_in_slab(
      Kind::ghost, 1,
      [](SlabMesh &slab) {
        for (double &value : slab.vertices.attributes[1].values)
          value += 0.5;
      },
      true);
}

TEST(ValidateBroken, WrongGhostNumber) {
  expect_in_slab(Kind::ghost, 3, [](SlabMesh &slab) {
    // The last number below the gap left by the slab's own sites, or any with room after it.
    for (std::size_t g = 0; g < slab.ghost_number.size(); ++g) {
      const GlobalIndex next = slab.ghost_number[g] + 1;
      const bool free = g + 1 == slab.ghost_number.size() || slab.ghost_number[g + 1] > next;
      if (free && (next < slab.first_site || next >= slab.first_site + slab.own_count)) {
        slab.ghost_number[g] = next;
        return;
      }
    }
  });
}

TEST(ValidateBroken, SitesOutOfOrder) {
  expect_in_slab(Kind::order, 2,
                 [](SlabMesh &slab) { std::swap(slab.vertices.points[0], slab.vertices.points[1]); });
  expect_in_slab(Kind::order, 2, [](SlabMesh &slab) { slab.vertices.points[1] = slab.vertices.points[0]; });
}

// Every slab ascends, but the whole does not.
TEST(ValidateBroken, SlabsOutOfOrder) {
  expect_in_slab(Kind::order, 3, [](SlabMesh &slab) {
    for (Point &p : slab.vertices.points)
      p.x -= 4;
  });
}

TEST(ValidateBroken, LineMoved) {
  const auto move = [](DistributedMesh &mesh) { mesh.lines[1] += 1; };
  expect_common(Kind::line, move);
  expect_common(Kind::slab, move);
}

TEST(ValidateBroken, WrongSums) {
  expect_common(
      Kind::checksum, [](DistributedMesh &mesh) { ++mesh.checksum; }, true);
  expect_common(
      Kind::digest, [](DistributedMesh &mesh) { ++mesh.digest.hash; }, true);
  expect_common(
      Kind::digest, [](DistributedMesh &mesh) { ++mesh.digest.points; }, true);
  expect_common(
      Kind::hull, [](DistributedMesh &mesh) { ++mesh.hull_edges; }, true);
}

TEST(ValidateBroken, WrongZ) {
  expect_in_slab(Kind::digest, 1, [](SlabMesh &slab) { slab.vertices.attributes[0].values[0] += 1; });
}

TEST(ValidateBroken, WrongPaths) {
  const auto expect = [](const SlabChange &change) { expect_in_slab(Kind::path, 2, change, true); };
  expect([](SlabMesh &slab) { slab.left_path.erase(slab.left_path.begin() + 1); });
  expect([](SlabMesh &slab) { slab.left_path.erase(slab.left_path.begin()); });
  expect([](SlabMesh &slab) { slab.left_path.pop_back(); });
  expect([](SlabMesh &slab) { slab.left_path.clear(); });
  expect([](SlabMesh &slab) { std::swap(slab.left_path[0], slab.left_path[1]); });
  expect([](SlabMesh &slab) { std::reverse(slab.left_path.begin(), slab.left_path.end()); });
  expect([](SlabMesh &slab) { slab.left_path[2] += 1; });
  expect([](SlabMesh &slab) { slab.left_path.push_back(slab.left_path.front()); });
  expect_in_slab(
      Kind::layout, 0, [](SlabMesh &slab) { slab.left_path.push_back(0); }, true);
}

TEST(ValidateBroken, WrongDuplicates) {
  const auto expect = [](Kind kind, const Change &change) {
    expect_common(kind, [&](DistributedMesh &mesh) {
      if (mesh.duplicates.size() > 1)
        change(mesh);
    });
  };
  expect(Kind::duplicate, [](DistributedMesh &mesh) { mesh.duplicates[0].site = -1; });
  expect(Kind::duplicate, [](DistributedMesh &mesh) { mesh.duplicates.back().site = 1 << 20; });
  expect(Kind::duplicate,
         [](DistributedMesh &mesh) { std::swap(mesh.duplicates.front(), mesh.duplicates.back()); });
  expect(Kind::duplicate, [](DistributedMesh &mesh) { mesh.duplicates[1] = mesh.duplicates[0]; });
  expect(Kind::digest, [](DistributedMesh &mesh) { mesh.duplicates[0].input_index += 1000; });
  expect(Kind::digest, [](DistributedMesh &mesh) { mesh.duplicates[0].z += 1; });
  expect(Kind::digest, [](DistributedMesh &mesh) { mesh.duplicates.pop_back(); });
  expect(Kind::digest, [](DistributedMesh &mesh) { mesh.duplicates.back().site -= 1; });
}

namespace {

/// Meshes made of other triangles, right in everything else.
ValidationReport report_of(const PointTable &points, const Triangles &triangles, int count,
                           Axis axis = Axis::x) {
  const Communicator comm = world();
  return validate(comm, oracle::make_mesh_of(points, triangles, {count, axis, comm.rank(), comm.size()}));
}

/// Flips the inner edge number `k` (modulo) of those that can be flipped.
Triangles flipped(const std::vector<Point> &sites, Triangles triangles, std::size_t k) {
  std::map<std::pair<LocalIndex, LocalIndex>, std::pair<std::size_t, LocalIndex>> across_edge;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      across_edge[{triangles[t][(i + 1) % 3], triangles[t][(i + 2) % 3]}] = {t, triangles[t][i]};
  const auto turn = [&](LocalIndex a, LocalIndex b, LocalIndex c) {
    const Point p = sites[at(a)], q = sites[at(b)], r = sites[at(c)];
    return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
  };
  std::vector<std::array<LocalIndex, 4>> flippable; // a, b the edge; c left of it, d right
  for (const auto &[edge, here] : across_edge) {
    const auto there = across_edge.find({edge.second, edge.first});
    if (there == across_edge.end() || edge.first > edge.second)
      continue;
    const LocalIndex c = here.second, d = there->second.second;
    if (turn(d, edge.second, c) > 0 && turn(c, edge.first, d) > 0)
      flippable.push_back({edge.first, edge.second, c, d});
  }
  const auto [a, b, c, d] = flippable[k % flippable.size()];
  triangles[across_edge[{a, b}].first] = {d, b, c};
  triangles[across_edge[{b, a}].first] = {c, a, d};
  return triangles;
}

} // namespace

// On a lattice many flips only break the tie the other way: the canonical rule has to see that.
TEST(ValidateBroken, EdgesFlipped) {
  for (const PointTable &points : {test_points(), oracle::table_of(oracle::random_points(80, 5))}) {
    const std::vector<Point> sites = oracle::sites_of(points, Axis::x);
    const Triangles triangles = oracle::wrap(sites);
    for (std::size_t k = 0; k < triangles.size(); k += 17)
      expect_found(report_of(points, flipped(sites, triangles, k), slabs), Kind::delaunay);
  }
}

TEST(ValidateBroken, EdgesFlippedOnBorders) {
  const PointTable points = oracle::table_of(oracle::random_points(40, 6));
  const std::vector<Point> sites = oracle::sites_of(points, Axis::x);
  const Triangles triangles = oracle::wrap(sites);
  for (std::size_t k = 0; k < triangles.size(); k += 5) {
    const ValidationReport report = report_of(points, flipped(sites, triangles, k), 20);
    expect_found(report, Kind::delaunay);
    EXPECT_GT(report.border_edges, report.inner_edges / 2);
  }
}

TEST(ValidateBroken, TriangleMissing) {
  const PointTable points = test_points();
  const Triangles triangles = oracle::wrap(oracle::sites_of(points, Axis::x));
  for (std::size_t k = 0; k < triangles.size(); k += 37) {
    Triangles fewer = triangles;
    fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(k));
    const ValidationReport report = report_of(points, fewer, slabs);
    expect_found(report, Kind::hull);
  }
}

TEST(ValidateBroken, TriangleTwice) {
  const PointTable points = test_points();
  Triangles triangles = oracle::wrap(oracle::sites_of(points, Axis::x));
  triangles.push_back(triangles[triangles.size() / 2]);
  const ValidationReport report = report_of(points, triangles, slabs);
  expect_found(report, Kind::adjacency);
  expect_found(report, Kind::euler);
}

// A triangle on the hull is missing: all that remains is fine but the hull, which turns right.
TEST(ValidateBroken, HullDented) {
  const PointTable points = oracle::table_of({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 1}});
  Triangles triangles = oracle::wrap(oracle::sites_of(points, Axis::x));
  EXPECT_EQ(triangles.size(), 4U);
  std::erase_if(triangles, [&](const auto &t) {
    const std::vector<Point> sites = oracle::sites_of(points, Axis::x);
    return std::ranges::none_of(t, [&](LocalIndex v) { return sites[at(v)].y == 4; });
  });
  EXPECT_EQ(triangles.size(), 3U); // without the one below
  expect_found(report_of(points, triangles, 1), Kind::hull, true);
}

// Five triangles around a centre that they pass twice: every local test and Euler's relation hold.
TEST(ValidateBroken, PentagonWoundTwice) {
  std::vector<Point> points{{0, 0}};
  for (int i = 0; i < 5; ++i)
    points.push_back({std::cos(0.3 + i * 0.4 * M_PI), std::sin(0.3 + i * 0.4 * M_PI)});
  const PointTable table = oracle::table_of(points);
  const std::vector<Point> sites = oracle::sites_of(table, Axis::x);
  const auto number = [&](int i) {
    return static_cast<LocalIndex>(std::ranges::find(sites, points[at(i)]) - sites.begin());
  };
  Triangles triangles;
  for (int i = 0; i < 5; ++i)
    triangles.push_back({number(0), number(1 + 2 * i % 5), number(1 + 2 * (i + 1) % 5)});
  for (const int count : {1, 3}) {
    const ValidationReport report = report_of(table, triangles, count);
    expect_found(report, Kind::hull);
    for (const Kind kind : {Kind::layout, Kind::order, Kind::orientation, Kind::slab, Kind::adjacency,
                            Kind::delaunay, Kind::euler, Kind::unused_site, Kind::checksum, Kind::digest})
      EXPECT_EQ(report.violations_by_kind[at(kind)], 0) << name_of(kind);
  }
  expect_found(report_of(table, triangles, 1), Kind::hull, true);
}

TEST(ValidateBroken, TwoIslands) {
  const std::vector<Point> points{{0, 0}, {1, 0}, {0, 1}, {10, 0}, {11, 0}, {10, 1}};
  const PointTable table = oracle::table_of(points);
  const std::vector<Point> sites = oracle::sites_of(table, Axis::x);
  Triangles triangles = oracle::wrap(sites);
  std::erase_if(triangles, [](const auto &t) {
    return std::ranges::min(t) < 3 && std::ranges::max(t) >= 3; // what joins the first three to the others
  });
  EXPECT_EQ(triangles.size(), 2U);
  expect_found(report_of(table, triangles, 2), Kind::hull);
}

TEST(ValidateBroken, SiteUnused) {
  PointTable points = oracle::table_of(oracle::random_points(60, 12));
  const std::vector<Point> sites = oracle::sites_of(points, Axis::x);
  // Triangulate without site 30, which is inside, and name the others as they are among all.
  std::vector<Point> fewer = sites;
  fewer.erase(fewer.begin() + 30);
  Triangles triangles = oracle::wrap(fewer);
  for (auto &t : triangles)
    for (LocalIndex &v : t)
      v += v >= 30;
  const ValidationReport report = report_of(points, triangles, slabs);
  expect_found(report, Kind::unused_site);
  expect_found(report, Kind::euler);
  EXPECT_EQ(report.violations_by_kind[at(Kind::unused_site)], 1);
}

TEST(ValidateBroken, NoTrianglesWhereThereShouldBe) {
  const std::vector<Point> bent{{0, 0}, {1, 0}, {2, 0}, {3, 1e-300}};
  for (const Axis axis : {Axis::x, Axis::y})
    for (const int count : {1, 3})
      expect_found(report_of(oracle::table_of(bent), {}, count, axis), Kind::collinear);
}

TEST(ValidateBroken, PathsOfCollinearSites) {
  const Communicator comm = world();
  for (const Point step : {Point{1, 0}, Point{1, -2}, Point{0, 1}}) {
    std::vector<Point> points;
    for (int i = 0; i < 8; ++i)
      points.push_back({step.x * i + 0.0, step.y * i + 0.0}); // not -0.0
    DistributedMesh mesh =
        oracle::make_mesh(oracle::table_of(points), {4, Axis::x, comm.rank(), comm.size()});
    EXPECT_TRUE(validate(comm, mesh).valid);
    for (SlabMesh &slab : mesh.slabs)
      if (!slab.left_path.empty())
        slab.left_path.pop_back();
    expect_found(validate(comm, mesh), Kind::path, true);
  }
}

namespace {

/// A mesh against points that are not its own; all on the first rank, which is any distribution as well.
void expect_other_input(const std::function<void(PointTable &)> &change) {
  const Communicator comm = world();
  const DistributedMesh mesh = good_mesh(comm);
  PointTable points = test_points();
  const PointTable nothing{{}, {}, {{"z", {}}, {"intensity", {}}}};
  EXPECT_TRUE(validate(comm, mesh, comm.is_root() ? points : nothing).valid);
  change(points);
  expect_found(validate(comm, mesh, comm.is_root() ? points : nothing), Kind::input, true);
}

} // namespace

TEST(ValidateBroken, OtherInput) {
  expect_other_input([](PointTable &points) { points.points[7].x += 1e-9; });
  expect_other_input([](PointTable &points) { points.attributes[0].values[7] += 1; });
  expect_other_input([](PointTable &points) { points.attributes.clear(); });
  expect_other_input([](PointTable &points) { points.input_index[7] = 1000; });
  expect_other_input([](PointTable &points) { points.input_index[7] = -1000; });
  expect_other_input([](PointTable &points) { std::swap(points.input_index[7], points.input_index[8]); });
  expect_other_input([](PointTable &points) { points = {}; });
  expect_other_input([](PointTable &points) {
    points.points.pop_back();
    points.input_index.pop_back();
    points.attributes[0].values.pop_back();
  });
  expect_other_input([](PointTable &points) {
    points.points.push_back({1, 1});
    points.input_index.push_back(150);
    points.attributes[0].values.push_back(0);
  });
}

// Both sums of a mesh can be made to fit a moved site; the input beside it tells.
TEST(ValidateBroken, ForgedSums) {
  const Communicator comm = world();
  PointTable points = oracle::table_of(oracle::random_points(60, 13));
  PointTable moved = points;
  moved.points[17].x = std::nextafter(moved.points[17].x, 2.0);
  const DistributedMesh mesh = oracle::make_mesh(moved, {slabs, Axis::x, comm.rank(), comm.size()});
  EXPECT_TRUE(validate(comm, mesh).valid);
  if (!comm.is_root())
    points = {};
  expect_found(validate(comm, mesh, points), Kind::input, true);
}

// A site that no input point has, under the greatest number there is: it belongs to the last round of
// comparing.
TEST(ValidateBroken, SiteBeyondAllInput) {
  const Communicator comm = world();
  PointTable points = oracle::table_of(oracle::random_points(60, 13));
  PointTable more = points;
  more.input_index.back() = std::numeric_limits<GlobalIndex>::max();
  const DistributedMesh mesh = oracle::make_mesh(more, {slabs, Axis::x, comm.rank(), comm.size()});
  EXPECT_TRUE(validate(comm, mesh).valid);
  points.points.pop_back();
  points.input_index.pop_back();
  for (Attribute &attribute : points.attributes)
    attribute.values.pop_back();
  if (!comm.is_root())
    points = {};
  expect_found(validate(comm, mesh, points), Kind::input, true);
}
