/// Insertion and removal of sites, and queries, on small sets: against the definition and against brute
/// force.
#include "dovetail/mesh/divide_and_conquer.hpp"
#include "dovetail/mesh/flip.hpp"
#include "dovetail/mesh/insert.hpp"
#include "dovetail/mesh/line_walk.hpp"
#include "dovetail/mesh/nearest.hpp"
#include "dovetail/mesh/remove.hpp"

#include "support/mesh_checks.hpp"
#include "support/small_sites_families.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace dovetail {
namespace {

using testing::checksum_of;
using testing::first_fault;
using testing::IntegerSite;

/// Integer sites moved by `shift` and then scaled by a power of two: exact as long as it fits 53 bits.
std::vector<Point> scaled(const std::vector<IntegerSite> &sites, std::int64_t shift, int exponent) {
  std::vector<Point> points;
  for (const IntegerSite &site : sites)
    points.push_back({std::ldexp(static_cast<double>(site.x + shift), exponent),
                      std::ldexp(static_cast<double>(site.y + shift), exponent)});
  return points;
}

std::vector<Point> small_points(int family, int most, std::mt19937_64 &random) {
  return scaled(testing::small_sites(family, most, random), 0, 0);
}

struct Mesh {
  std::vector<Point> sites;
  Triangulation triangles;
};

using Insert = Insertion (*)(std::vector<Point> &, Triangulation &, Point, LocalIndex, Cavity &);

Mesh one_by_one(Insert insert_one, const std::vector<Point> &points, bool with_hints) {
  Mesh mesh;
  Cavity memory;
  LocalIndex hint = none;
  for (const Point &point : points) {
    const Insertion done = insert_one(mesh.sites, mesh.triangles, point, hint, memory);
    EXPECT_TRUE(done.is_new);
    EXPECT_EQ(mesh.sites[position(done.vertex)], point);
    hint = with_hints ? done.triangle : none;
  }
  return mesh;
}

void expect_canonical(const Mesh &mesh, std::uint64_t checksum, const char *what) {
  const FaultReport report = validate(mesh.sites, mesh.triangles);
  ASSERT_TRUE(report.valid()) << what << ": " << first_fault(report);
  ASSERT_EQ(checksum_of(mesh.sites, mesh.triangles), checksum) << what;
}

class SmallFamilies : public ::testing::TestWithParam<int> {};

INSTANTIATE_TEST_SUITE_P(Mesh, SmallFamilies, ::testing::Range(0, testing::small_sites_family_count),
                         [](const auto &family) {
                           std::string name = testing::small_sites_family_name(family.param);
                           std::ranges::replace(name, ' ', '_');
                           return name;
                         });

/// In input, sorted and space-filling order, by cavities and by flips, and by growing what divide and conquer
/// made.
TEST_P(SmallFamilies, EveryWayToTheSameMesh) {
  std::mt19937_64 random(static_cast<std::uint64_t>(GetParam()) + 1);
  for (int round = 0; round < 150; ++round) {
    const std::vector<IntegerSite> sites =
        testing::small_sites(GetParam(), round % 10 == 0 ? 40 : 16, random);
    const std::pair<std::int64_t, int> placements[] = {
        {0, 0}, {std::int64_t{1} << 51, -51}, {7, 498}, {-3, -498}, {0, -1000}, {0, 980}};
    for (const auto &[shift, exponent] : placements) {
      std::vector<Point> points = scaled(sites, shift, exponent);
      const std::uint64_t checksum = checksum_of(points, delaunay(points));
      expect_canonical(one_by_one(insert, points, false), checksum, "cavities");
      expect_canonical(one_by_one(insert_by_flips, points, true), checksum, "flips");
      Mesh batch;
      insert_batch(batch.sites, batch.triangles, points);
      expect_canonical(batch, checksum, "batch");
      Mesh grown;
      grown.sites.assign(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2));
      grown.triangles = delaunay(grown.sites);
      insert_batch(grown.sites, grown.triangles, std::span(points).subspan(points.size() / 2));
      expect_canonical(grown, checksum, "divide and conquer, and a batch");
      std::ranges::sort(points, lexicographically_less);
      expect_canonical(one_by_one(insert, points, true), checksum, "cavities, sorted");
      expect_canonical(one_by_one(insert_by_flips, points, true), checksum, "flips, sorted");
      if (HasFatalFailure())
        FAIL() << "round " << round << " scaled by 2^" << exponent;
    }
  }
}

/// One after the other to the last, and half of them at once.
TEST_P(SmallFamilies, Removal) {
  std::mt19937_64 random(static_cast<std::uint64_t>(GetParam()) + 50);
  for (int round = 0; round < 150; ++round) {
    const std::vector<Point> points = small_points(GetParam(), round % 10 == 0 ? 40 : 16, random);
    Mesh mesh{points, delaunay(points)};
    RemovalMemory memory;
    std::vector<Point> left = points;
    while (!left.empty()) {
      const auto vertex = static_cast<LocalIndex>(random() % left.size());
      const Removal done = remove(mesh.sites, mesh.triangles, vertex, none, memory);
      ASSERT_EQ(done.moved == none, position(vertex) + 1 == left.size());
      ASSERT_TRUE(done.triangle < mesh.triangles.triangle_count());
      left[position(vertex)] = left.back();
      left.pop_back();
      ASSERT_EQ(mesh.sites, left);
      expect_canonical(mesh, checksum_of(left, delaunay(left)), "removal");
      if (HasFatalFailure())
        FAIL() << "round " << round << ", " << left.size() << " sites left";
    }
    Mesh half{points, delaunay(points)};
    std::vector<LocalIndex> some;
    for (std::size_t v = 0; v < points.size(); v += 2)
      some.push_back(static_cast<LocalIndex>(v));
    const std::vector<LocalIndex> number = remove_batch(half.sites, half.triangles, some);
    for (std::size_t v = 0; v < points.size(); ++v)
      if (v % 2 == 0) {
        ASSERT_EQ(number[v], none);
      } else {
        ASSERT_EQ(half.sites[position(number[v])], points[v]);
        left.push_back(points[v]);
      }
    expect_canonical(half, checksum_of(left, delaunay(left)), "removal of a batch");
  }
}

/// Known sites are found, wherever the walk begins, and change nothing.
TEST_P(SmallFamilies, DuplicatesAreMapped) {
  std::mt19937_64 random(static_cast<std::uint64_t>(GetParam()) + 100);
  for (int round = 0; round < 100; ++round) {
    std::vector<Point> points = small_points(GetParam(), 16, random);
    Mesh mesh;
    const std::vector<LocalIndex> vertices = insert_batch(mesh.sites, mesh.triangles, points);
    std::vector<Point> twice = points;
    twice.insert(twice.end(), points.rbegin(), points.rend());
    const Mesh before = mesh;
    const std::vector<LocalIndex> again = insert_batch(mesh.sites, mesh.triangles, twice);
    for (std::size_t i = 0; i < points.size(); ++i) {
      ASSERT_EQ(again[i], vertices[i]);
      ASSERT_EQ(again[twice.size() - 1 - i], vertices[i]);
    }
    ASSERT_EQ(mesh.sites, before.sites);
    ASSERT_EQ(mesh.triangles.corners, before.triangles.corners);
    Mesh fresh;
    insert_in_order(fresh.sites, fresh.triangles, twice);
    ASSERT_EQ(fresh.sites, points); // the first of equal points becomes the site
    expect_canonical(fresh, checksum_of(points, delaunay(points)), "twice");
  }
}

TEST_P(SmallFamilies, NearestSite) {
  std::mt19937_64 random(static_cast<std::uint64_t>(GetParam()) + 150);
  for (int round = 0; round < 100; ++round) {
    const std::vector<Point> sites = small_points(GetParam(), 16, random);
    if (sites.empty())
      continue;
    const Triangulation mesh = delaunay(sites);
    for (int query = 0; query < 20; ++query) {
      const Point base = sites[random() % sites.size()];
      const Point point{base.x + static_cast<double>(random() % 9) / 2 - 2,
                        base.y + static_cast<double>(random() % 9) / 2 - 2};
      LocalIndex best = 0;
      for (std::size_t v = 1; v < sites.size(); ++v)
        if (nearer(sites[v], sites[position(best)], point))
          best = static_cast<LocalIndex>(v);
      ASSERT_EQ(nearest_site(sites, mesh, point, none), best);
    }
  }
}

/// Neither a side of the triangle nor the line of the segment separates the two.
bool interior_meets(std::span<const Point> corners, Point from, Point to) {
  bool left = false, right = false;
  for (std::size_t i = 0; i < 3; ++i) {
    const Point a = corners[i], b = corners[(i + 1) % 3];
    if (orientation(a, b, from) != Sign::positive && orientation(a, b, to) != Sign::positive)
      return false;
    left |= orientation(from, to, a) == Sign::positive;
    right |= orientation(from, to, a) == Sign::negative;
  }
  return from == to || (left && right);
}

TEST_P(SmallFamilies, TrianglesAlongALine) {
  std::mt19937_64 random(static_cast<std::uint64_t>(GetParam()) + 200);
  for (int round = 0; round < 150; ++round) {
    const std::vector<Point> sites = small_points(GetParam(), 16, random);
    const Triangulation mesh = delaunay(sites);
    for (int query = 0; query < 20 && mesh.triangle_count() > 0; ++query) {
      const auto end = [&] {
        const Point base = sites[random() % sites.size()];
        return Point{base.x + static_cast<double>(random() % 5) / 2 - 1,
                     base.y + static_cast<double>(random() % 5) / 2 - 1};
      };
      const Point from = end(), to = query % 5 == 0 ? sites[random() % sites.size()] : end();
      std::vector<LocalIndex> expected;
      for (LocalIndex t = 0; t < mesh.triangle_count(); ++t) {
        std::vector<Point> corners;
        for (int i = 0; i < 3; ++i)
          corners.push_back(sites[position(mesh.corners[position(half_edge(t, i))])]);
        if (interior_meets(corners, from, to))
          expected.push_back(t);
      }
      std::vector<LocalIndex> found = triangles_along(sites, mesh, from, to, 0);
      std::vector<LocalIndex> back = triangles_along(sites, mesh, to, from, mesh.triangle_count() - 1);
      std::ranges::reverse(back);
      ASSERT_EQ(found, back) << "round " << round;
      std::ranges::sort(found);
      ASSERT_EQ(found, expected) << "round " << round << " from " << from.x << ' ' << from.y << " to " << to.x
                                 << ' ' << to.y;
    }
  }
}

/// Is the place what it says? Brute force.
void expect_place(const std::vector<Point> &sites, const Triangulation &mesh, Point point, Place place) {
  const HalfEdge h = half_edge(place.triangle, place.side);
  const auto side = [&](HalfEdge of) {
    return orientation(sites[position(origin(mesh, of))], sites[position(target(mesh, of))], point);
  };
  switch (place.kind) {
  case PlaceKind::vertex:
    ASSERT_EQ(sites[position(apex(mesh, h))], point);
    break;
  case PlaceKind::edge:
    ASSERT_EQ(side(h), Sign::zero);
    ASSERT_EQ(side(after(h)), Sign::positive);
    ASSERT_EQ(side(before(h)), Sign::positive);
    break;
  case PlaceKind::inside:
    for (int i = 0; i < 3; ++i)
      ASSERT_EQ(side(half_edge(place.triangle, i)), Sign::positive);
    break;
  case PlaceKind::outside:
    ASSERT_EQ(side(h), Sign::negative);
    ASSERT_EQ(twin(mesh, h), none);
    break;
  case PlaceKind::blocked:
    FAIL() << "nothing is locked";
  }
}

/// In a mesh that is not Delaunay, made by flipping at random, a walk could go round in circles.
TEST_P(SmallFamilies, LocateEndsInAnyTriangulation) {
  std::mt19937_64 random(static_cast<std::uint64_t>(GetParam()) + 250);
  for (int round = 0; round < 100; ++round) {
    const std::vector<Point> sites = small_points(GetParam(), 24, random);
    Triangulation mesh = delaunay(sites);
    for (int i = 0; i < 100 && mesh.triangle_count() > 0; ++i) {
      const auto h = static_cast<HalfEdge>(random() % mesh.corners.size());
      const HalfEdge across = twin(mesh, h);
      if (across == none)
        continue;
      const Point a = sites[position(origin(mesh, h))], b = sites[position(target(mesh, h))];
      const Point c = sites[position(apex(mesh, h))], d = sites[position(apex(mesh, across))];
      if (orientation(c, a, d) == Sign::positive && orientation(c, d, b) == Sign::positive)
        flip(mesh, h);
      const Point point{c.x + static_cast<double>(random() % 5) / 2 - 1,
                        c.y + static_cast<double>(random() % 5) / 2 - 1};
      const auto hint = static_cast<LocalIndex>(random() % position(mesh.triangle_count()));
      ASSERT_NO_FATAL_FAILURE(expect_place(sites, mesh, point, locate(sites, mesh, point, hint)));
      ASSERT_NO_FATAL_FAILURE(expect_place(sites, mesh, d, locate(sites, mesh, d, hint)));
    }
    // Lawson's flips repair it, whatever it has become.
    std::vector<HalfEdge> all(mesh.corners.size());
    for (std::size_t h = 0; h < all.size(); ++h)
      all[h] = static_cast<HalfEdge>(h);
    flip_to_delaunay(sites, mesh, all);
    expect_canonical({sites, mesh}, checksum_of(sites, delaunay(sites)), "flipped back");
  }
}

/// What a caller keeps by side: here the pair of its ends, so that it can be checked.
TEST_P(SmallFamilies, ValuesOfSidesAreCarried) {
  using Pair = std::pair<LocalIndex, LocalIndex>;
  std::mt19937_64 random(static_cast<std::uint64_t>(GetParam()) + 300);
  for (int round = 0; round < 100; ++round) {
    const std::vector<Point> points = small_points(GetParam(), 24, random);
    Mesh mesh;
    mesh.sites.assign(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2));
    mesh.triangles = delaunay(mesh.sites);
    if (mesh.triangles.triangle_count() == 0)
      continue;
    const auto ends = [&](HalfEdge h) {
      return std::minmax({origin(mesh.triangles, h), target(mesh.triangles, h)});
    };
    std::vector<Pair> value, kept;
    for (std::size_t h = 0; h < mesh.triangles.corners.size(); ++h)
      value.emplace_back(ends(static_cast<HalfEdge>(h)));
    Cavity cavity;
    for (const Point &point : std::span(points).subspan(points.size() / 2)) {
      const Place place = locate(mesh.sites, mesh.triangles, point, 0);
      find_cavity(mesh.sites, mesh.triangles, point, place, cavity);
      const auto vertex = static_cast<LocalIndex>(mesh.sites.size());
      const Pair whole = std::minmax({cavity.split_from, cavity.split_to});
      const LocalIndex first_new = commit(mesh.triangles, cavity, vertex);
      mesh.sites.push_back(point);
      carry_sides(cavity, first_new, Pair{none, none}, value, kept);
      ASSERT_EQ(value.size(), mesh.triangles.corners.size());
      for (std::size_t i = 0; i < value.size(); ++i) {
        const auto h = static_cast<HalfEdge>(i);
        Pair expected = ends(h);
        if (expected.second == vertex) {
          const bool is_half =
              cavity.split != none && (expected.first == whole.first || expected.first == whole.second);
          ASSERT_EQ(value[i], is_half ? whole : (Pair{none, none}));
          value[i] = expected;
        }
        ASSERT_EQ(value[i], expected);
      }
    }
  }
}

/// Locked edges stop walks and cavities, and both say so.
TEST(LockedEdges, StopWalksAndCavities) {
  //  3 --- 2 --- 5     the edge from 1 to 2 is locked
  //  |   / |   / |
  //  | /   | /   |
  //  0 --- 1 --- 4
  const std::vector<Point> sites{{0, 0}, {4, 0}, {4, 4.5}, {0, 4}, {8, 0}, {8, 4}};
  Triangulation mesh = delaunay(sites);
  const auto locked = [&](LocalIndex t, int side) {
    const auto ends = std::minmax({origin(mesh, half_edge(t, side)), target(mesh, half_edge(t, side))});
    return ends.first == 1 && ends.second == 2;
  };
  const auto left = [&](Point p) { return p.x < 4; };
  const LocalIndex hint = locate(sites, mesh, {3.5, 2}, 0).triangle;
  const Place blocked = locate(sites, mesh, {7, 1}, hint, locked);
  ASSERT_EQ(blocked.kind, PlaceKind::blocked);
  EXPECT_TRUE(locked(blocked.triangle, blocked.side));
  EXPECT_EQ(locate(sites, mesh, {7, 1}, hint).kind, PlaceKind::inside);

  Cavity cavity;
  const Point near{3.75, 2};
  find_cavity(sites, mesh, near, locate(sites, mesh, near, 0), cavity);
  const std::size_t unlimited = cavity.triangles.size();
  EXPECT_FALSE(cavity.has_locked_side);
  find_cavity(sites, mesh, near, locate(sites, mesh, near, 0), cavity, locked);
  EXPECT_TRUE(cavity.has_locked_side);
  EXPECT_LT(cavity.triangles.size(), unlimited);
  for (const CavityEdge &edge : cavity.edges)
    EXPECT_TRUE(left(sites[position(edge.from)]) || edge.from == 1 || edge.from == 2);

  // A site on the locked edge splits it: both sides are in its cavity.
  const Point on{4, 2};
  const Place place = locate(sites, mesh, on, hint, locked);
  ASSERT_EQ(place.kind, PlaceKind::edge);
  find_cavity(sites, mesh, on, place, cavity, locked);
  EXPECT_TRUE(cavity.has_locked_side);
  EXPECT_EQ(std::minmax({cavity.split_from, cavity.split_to}), std::minmax({1, 2}));
  EXPECT_EQ(cavity.triangles.size(), 4U);
}

} // namespace
} // namespace dovetail
