// One checksum for every number of slabs, either axis, order of the input and kernel, on every kind of
// points; and a valid mesh each time. One program for each number of ranks; all compare with the same oracle,
// the sequential kernel merge over the distinct points.
//
// By default a selection in which every pair of values of (ranks, slabs, axis, order, kernel, points)
// occurs;
// everything under DOVETAIL_FULL=1.
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/exchange.hpp"
#include "dovetail/distributed/triangulate.hpp"
#include "dovetail/distributed/validate.hpp"
#include "dovetail/geometry/distributions.hpp"
#include "dovetail/io/points.hpp"
#include "dovetail/mesh/checksum.hpp"
#include "dovetail/mesh/divide_and_conquer.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <set>

namespace dovetail {
namespace {

constexpr std::array<int, 6> rank_counts{1, 2, 3, 4, 5, 8};

struct Points {
  const char *name;
  SyntheticSet set; ///< of n = 0 if they come from a file
  const char *file = "";
};

const std::array<Points, 9> all_points{{{"uniform", {Distribution::uniform, 100000, 1}},
                                        {"normal", {Distribution::normal, 100000, 2}},
                                        {"kuzmin", {Distribution::kuzmin, 100000, 3}},
                                        {"line", {Distribution::line, 100000, 4}},
                                        {"clusters", {Distribution::clusters, 100000, 5}},
                                        {"lattice", {Distribution::lattice, 90000, 6}},
                                        {"circle", {Distribution::circle, 20000, 7}},
                                        {"lidar", {Distribution::lidar, 200000, 8}},
                                        {"autzen_trim", {}, "autzen_trim.las"}}};

struct Way {
  int slabs_choice; ///< 0: as many as ranks, 1: 7, 2: 16
  bool along_y;
  bool shuffled;
  Kernel kernel;
};

/// The selection: for every pair of ranks and points one way.
Way selected_way(std::size_t ranks_choice, std::size_t points_choice) {
  return {static_cast<int>((ranks_choice + points_choice) % 3),
          (ranks_choice / 3 + points_choice + points_choice / 3) % 2 == 1,
          (ranks_choice + points_choice / 2) % 2 == 1,
          (ranks_choice + points_choice) % 2 == 1 ? Kernel::split_path : Kernel::merge};
}

std::string name_of(const Way &way) {
  return fmt::format("slabs {} y {} shuffled {} {}", way.slabs_choice, way.along_y, way.shuffled,
                     way.kernel == Kernel::merge ? "merge" : "split path");
}

bool full() {
  const char *value = std::getenv("DOVETAIL_FULL");
  return value != nullptr && std::string_view(value) == "1";
}

std::string data_file(const std::string &name) {
  const char *folder = std::getenv("DOVETAIL_DATA");
  return (folder != nullptr ? std::filesystem::path(folder) : std::filesystem::path(DOVETAIL_DEFAULT_DATA)) /
         name;
}

/// This rank's share of the points, in the order of the input.
PointTable share(const Communicator &comm, const Points &points) {
  if (points.file[0] != '\0') {
    const std::array<std::string, 1> paths{data_file(points.file)};
    return read_points(comm, paths).points;
  }
  const GlobalIndex first = points.set.n * comm.rank() / comm.size();
  const GlobalIndex end = points.set.n * (comm.rank() + 1) / comm.size();
  PointTable table;
  table.points.resize(static_cast<std::size_t>(end - first));
  generate_points(points.set, first, table.points);
  table.input_index.resize(table.points.size());
  std::iota(table.input_index.begin(), table.input_index.end(), first);
  return table;
}

/// The same points elsewhere: each goes to the rank that a hash of its input index says, in reverse.
PointTable shuffle(const Communicator &comm, const PointTable &table) {
  struct Record {
    Point point;
    GlobalIndex index;
  };
  std::vector<std::vector<Record>> letters(static_cast<std::size_t>(comm.size()));
  for (std::size_t i = table.points.size(); i-- > 0;) {
    const std::uint64_t hash = synthetic::mix(static_cast<std::uint64_t>(table.input_index[i]) + 99);
    letters[hash % letters.size()].push_back({table.points[i], table.input_index[i]});
  }
  std::vector<Record> send;
  std::vector<std::int64_t> counts;
  for (const std::vector<Record> &letter : letters) {
    send.insert(send.end(), letter.begin(), letter.end());
    counts.push_back(static_cast<std::int64_t>(letter.size()));
  }
  PointTable shuffled;
  for (const Record &record : exchange<Record>(comm, send, counts).data) {
    shuffled.points.push_back(record.point);
    shuffled.input_index.push_back(record.index);
  }
  for (const Attribute &attribute : table.attributes)
    shuffled.attributes.push_back({attribute.name, std::vector<double>(shuffled.points.size())});
  return shuffled;
}

struct Expected {
  GlobalIndex sites = 0;
  GlobalIndex triangles = 0;
  std::uint64_t checksum = 0;
};

/// What the sequential kernel makes of all points.
Expected oracle(const Communicator &comm, const PointTable &table) {
  std::vector<Point> sites = gather_bulk<Point>(comm, table.points).data;
  Expected expected;
  if (comm.is_root()) {
    std::sort(sites.begin(), sites.end(), lexicographically_less);
    sites.erase(std::unique(sites.begin(), sites.end()), sites.end());
    const Triangulation triangles = delaunay(sites);
    expected = {static_cast<GlobalIndex>(sites.size()), triangles.triangle_count(),
                checksum_of_sites(sites) + checksum_of_triangles(sites, triangles.corners)};
  }
  broadcast(comm, expected.sites);
  broadcast(comm, expected.triangles);
  broadcast(comm, expected.checksum);
  return expected;
}

void check(const Communicator &comm, const PointTable &table, const Way &way, const Expected &expected) {
  PointTable input = way.shuffled ? shuffle(comm, table) : table;
  TriangulateOptions options;
  options.slabs.slabs = way.slabs_choice == 0 ? comm.size() : way.slabs_choice == 1 ? 7 : 16;
  options.slabs.axis = way.along_y ? AxisChoice::y : AxisChoice::x;
  options.kernel.kernel = way.kernel;
  const PointTable kept = input;
  const DistributedMesh mesh = triangulate(comm, std::move(input), options);
  EXPECT_EQ(mesh.slab_count(), options.slabs.slabs);
  EXPECT_EQ(mesh.site_count(), expected.sites);
  EXPECT_EQ(mesh.triangle_count(), expected.triangles);
  EXPECT_EQ(mesh.checksum, expected.checksum);
  const ValidationReport found = validate(comm, mesh, kept);
  EXPECT_TRUE(found.valid) << (found.first_violations.empty() ? "" : found.first_violations.front().text);
  EXPECT_EQ(found.checksum, expected.checksum);
}

class Matrix : public testing::TestWithParam<std::size_t> {};

TEST_P(Matrix, OneChecksum) {
  const Communicator comm = Communicator::duplicate(boost::mpi::communicator());
  const Points &points = all_points[GetParam()];
  if (points.file[0] != '\0' && !std::filesystem::exists(data_file(points.file))) {
    EXPECT_FALSE(full()) << data_file(points.file) << " is absent; set DOVETAIL_DATA";
    GTEST_SKIP() << points.file << " is absent";
  }
  const auto ranks_choice = static_cast<std::size_t>(
      std::find(rank_counts.begin(), rank_counts.end(), comm.size()) - rank_counts.begin());
  const PointTable table = share(comm, points);
  const Expected expected = oracle(comm, table);
  if (!full()) {
    const Way way = selected_way(ranks_choice, GetParam());
    SCOPED_TRACE(name_of(way));
    check(comm, table, way, expected);
    return;
  }
  for (int slabs = 0; slabs < 3; ++slabs)
    for (const bool along_y : {false, true})
      for (const bool shuffled : {false, true})
        for (const Kernel kernel : {Kernel::merge, Kernel::split_path}) {
          const Way way{slabs, along_y, shuffled, kernel};
          SCOPED_TRACE(name_of(way));
          check(comm, table, way, expected);
        }
}

INSTANTIATE_TEST_SUITE_P(Points, Matrix, testing::Range(std::size_t{0}, all_points.size()),
                         [](const auto &parameter) { return all_points[parameter.param].name; });

/// That the selection is what it says.
TEST(Selection, HasEveryPair) {
  std::set<std::array<std::size_t, 4>> pairs; // factor, value, factor, value
  for (std::size_t r = 0; r < rank_counts.size(); ++r)
    for (std::size_t p = 0; p < all_points.size(); ++p) {
      const Way way = selected_way(r, p);
      const std::array<std::size_t, 6> values{r,
                                              static_cast<std::size_t>(way.slabs_choice),
                                              way.along_y,
                                              way.shuffled,
                                              way.kernel == Kernel::merge,
                                              p};
      for (std::size_t a = 0; a < values.size(); ++a)
        for (std::size_t b = a + 1; b < values.size(); ++b)
          pairs.insert({a, values[a], b, values[b]});
    }
  constexpr std::array<std::size_t, 6> levels{6, 3, 2, 2, 2, 9};
  std::size_t expected = 0;
  for (std::size_t a = 0; a < levels.size(); ++a)
    for (std::size_t b = a + 1; b < levels.size(); ++b)
      expected += levels[a] * levels[b];
  EXPECT_EQ(pairs.size(), expected);
}

} // namespace
} // namespace dovetail
