// Sorting on disk beside sorting in memory, and streaming beside keeping, with so little room that everything
// goes in many pieces.
#include "dovetail/comm/agreement.hpp"
#include "dovetail/distributed/scratch_sites.hpp"
#include "dovetail/distributed/sort_on_disk.hpp"
#include "dovetail/distributed/stream_mesh.hpp"
#include "dovetail/distributed/triangulate.hpp"
#include "dovetail/geometry/distributions.hpp"
#include "mpi/pipeline_support.hpp"
#include "support/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace dovetail::testing {
namespace {

/// Points that are there already, as if they were read.
class TableStream : public PointStream {
public:
  explicit TableStream(PointTable table) : table_(std::move(table)) {
    for (const Attribute &attribute : table_.attributes)
      names_.push_back(attribute.name);
  }
  const std::vector<std::string> &attribute_names() const override { return names_; }
  bool next(std::size_t most, PointTable &piece) override {
    const std::size_t begin = at_;
    at_ = std::min(table_.points.size(), at_ + most);
    const auto rows = [&](const auto &column) {
      return std::remove_cvref_t<decltype(column)>(column.begin() + static_cast<std::ptrdiff_t>(begin),
                                                   column.begin() + static_cast<std::ptrdiff_t>(at_));
    };
    piece.points = rows(table_.points);
    piece.input_index = rows(table_.input_index);
    for (std::size_t a = 0; a < names_.size(); ++a)
      piece.attributes[a].values = rows(table_.attributes[a].values);
    return at_ > begin;
  }
  void begin_again() override { at_ = 0; }

private:
  PointTable table_;
  std::vector<std::string> names_;
  std::size_t at_ = 0;
};

/// Keeps what it is given.
struct Kept : SlabSink {
  void begin(const Communicator &, const MeshOutline &all) override { outline = all; }
  void take(int, const SlabMesh &mesh, std::span<const Duplicate> of) override {
    slabs.push_back(mesh);
    duplicates.insert(duplicates.end(), of.begin(), of.end());
  }
  void complete(int slab, const SlabMesh &border) override {
    SlabMesh &mesh = slabs[static_cast<std::size_t>(slab - outline.mesh.first_slab)];
    mesh.border_sides = border.border_sides;
    const auto add = [](auto &column, const auto &more) {
      column.insert(column.end(), more.begin(), more.end());
    };
    add(mesh.vertices.input_index, border.vertices.input_index);
    for (std::size_t a = 0; a < mesh.vertices.attributes.size(); ++a)
      add(mesh.vertices.attributes[a].values, border.vertices.attributes[a].values);
  }
  void finish(std::uint64_t sum, GlobalIndex edges) override {
    checksum = sum;
    hull_edges = edges;
  }

  MeshOutline outline;
  std::vector<SlabMesh> slabs;
  std::vector<Duplicate> duplicates;
  std::uint64_t checksum = 0;
  GlobalIndex hull_edges = 0;
};

struct Case {
  std::vector<Point> points;
  int slabs;
  AxisChoice axis;
  DuplicateRule rule;
};

SlabOptions options_of(const Case &c) {
  SlabOptions options;
  options.slabs = c.slabs;
  options.axis = c.axis;
  options.duplicates = c.rule;
  return options;
}

Slabs on_disk(const Communicator &comm, const TemporaryFolder &folder, const Case &c, std::int64_t memory) {
  TableStream stream(deal(comm, c.points, 5));
  return sort_on_disk(comm, stream, options_of(c), {folder.file(""), memory, 0});
}

bool same(const PointTable &a, const PointTable &b) {
  return a.points == b.points && a.input_index == b.input_index &&
         std::ranges::equal(a.attributes, b.attributes,
                            [](const Attribute &x, const Attribute &y) { return x.values == y.values; });
}

void expect_same_slabs(const Slabs &memory, const Slabs &disk) {
  EXPECT_EQ(memory.axis, disk.axis);
  EXPECT_EQ(memory.site_offsets, disk.site_offsets);
  EXPECT_EQ(memory.lines, disk.lines);
  EXPECT_EQ(memory.first_slab, disk.first_slab);
  ASSERT_EQ(memory.own_slab_count, disk.own_slab_count);
  EXPECT_EQ(memory.digest.points, disk.digest.points);
  EXPECT_EQ(memory.digest.hash, disk.digest.hash);
  std::vector<Point> buffer, other;
  for (int k = 0; k < memory.own_slab_count; ++k) {
    EXPECT_TRUE(same(table_of_slab(memory, k, 3), table_of_slab(disk, k, 0))) << k;
    EXPECT_TRUE(std::ranges::equal(points_of_slab(memory, k, buffer), points_of_slab(disk, k, other))) << k;
    EXPECT_EQ(duplicates_of_slab(memory, k), duplicates_of_slab(disk, k)) << k;
  }
  std::vector<GlobalIndex> numbers;
  for (GlobalIndex i = memory.first_site(); i < memory.first_site() + std::ssize(memory.sites.points); i += 3)
    numbers.push_back(i);
  EXPECT_EQ(records_of_sites(memory, numbers), records_of_sites(disk, numbers));
}

void expect_same_mesh(const DistributedMesh &kept, const Kept &streamed) {
  EXPECT_EQ(kept.checksum, streamed.checksum);
  EXPECT_EQ(kept.hull_edges, streamed.hull_edges);
  EXPECT_EQ(kept.triangle_offsets, streamed.outline.mesh.triangle_offsets);
  EXPECT_EQ(kept.duplicates, streamed.duplicates);
  ASSERT_EQ(kept.slabs.size(), streamed.slabs.size());
  for (std::size_t k = 0; k < kept.slabs.size(); ++k) {
    const SlabMesh &a = kept.slabs[k], &b = streamed.slabs[k];
    const auto s = static_cast<std::size_t>(kept.first_slab) + k;
    EXPECT_TRUE(same(a.vertices, b.vertices)) << k;
    EXPECT_EQ(std::ssize(a.vertices.points),
              streamed.outline.vertex_offsets[s + 1] - streamed.outline.vertex_offsets[s]);
    EXPECT_EQ(a.triangles.corners, b.triangles.corners);
    EXPECT_EQ(a.triangles.neighbours, b.triangles.neighbours);
    EXPECT_EQ(a.first_triangle, b.first_triangle);
    EXPECT_EQ(a.ghost_number, b.ghost_number);
    EXPECT_EQ(a.left_path, b.left_path);
    EXPECT_TRUE(
        std::ranges::equal(a.border_sides, b.border_sides, [](const BorderSide &x, const BorderSide &y) {
          return x.side == y.side && x.neighbour == y.neighbour;
        }));
  }
}

std::vector<Case> cases() {
  std::vector<Case> all;
  const auto generated = [](Distribution distribution, std::size_t count) {
    std::vector<Point> points(count);
    generate_points({distribution, static_cast<GlobalIndex>(count), 3}, 0, points);
    return points;
  };
  std::vector<Point> crowded =
      generated(Distribution::uniform, 300); // forty points at each of thirty positions
  for (std::size_t i = 0; i < 1200; ++i)
    crowded.push_back(crowded[i % 30]);
  std::vector<Point> column,
      cluster = generated(Distribution::uniform, 300); // so dense that no sample sees how
  for (int i = 0; i < 600; ++i)
    column.push_back({1, static_cast<double>(i * 7919 % 601)});
  for (int i = 0; i < 1000; ++i) {
    const int row = i / 55, column_of_row = i % 55;
    cluster.push_back({0.5 + 1e-14 * column_of_row, 0.5 + 1e-14 * row});
  }
  for (const DuplicateRule rule : {DuplicateRule::first, DuplicateRule::highest})
    all.push_back({crowded, 6, AxisChoice::x, rule});
  all.push_back({generated(Distribution::kuzmin, 1500), 7, AxisChoice::automatic, DuplicateRule::first});
  all.push_back({generated(Distribution::lattice, 900), 16, AxisChoice::y, DuplicateRule::first});
  all.push_back({column, 5, AxisChoice::automatic, DuplicateRule::first});
  all.push_back({cluster, 9, AxisChoice::x, DuplicateRule::lowest});
  all.push_back({{{1, 2}}, 4, AxisChoice::x, DuplicateRule::first});
  all.push_back({{}, 3, AxisChoice::x, DuplicateRule::first});
  return all;
}

TEST(SortOnDisk, IsSortingInMemory) {
  Communicator comm = world();
  comm.set_chunk_bytes(100);
  const TemporaryFolder folder(comm);
  for (const Case &c : cases())
    for (const std::int64_t memory : {0, 300000}) {
      const Slabs kept = sort_into_slabs(comm, deal(comm, c.points, 9), options_of(c));
      Slabs waiting = on_disk(comm, folder, c, memory);
      expect_same_slabs(kept, waiting);
      Kept from_memory, from_disk;
      const DistributedMesh mesh = triangulate(comm, deal(comm, c.points, 1), {options_of(c), nullptr, {}});
      triangulate_into(comm, deal(comm, c.points, 2), from_memory, {}, {options_of(c), nullptr, {}});
      triangulate_into(comm, std::move(waiting), from_disk, {}, {options_of(c), nullptr, {}});
      expect_same_mesh(mesh, from_memory);
      expect_same_mesh(mesh, from_disk);
    }
}

std::string refusal_of(const std::function<void()> &work) {
  try {
    work();
  } catch (const Error &error) {
    return error.what();
  }
  return "";
}

TEST(SortOnDisk, RefusesOnAllRanksAlike) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const Case equals{std::vector<Point>(1000, Point{3, 4}), 2, AxisChoice::x, DuplicateRule::first};
  EXPECT_NE(refusal_of([&] { on_disk(comm, folder, equals, 0); }).find("1000 points are at one position"),
            std::string::npos);
  Case faulty = cases()[0];
  faulty.rule = DuplicateRule::error;
  const std::string in_memory =
      refusal_of([&] { sort_into_slabs(comm, deal(comm, faulty.points, 1), options_of(faulty)); });
  EXPECT_NE(in_memory, "");
  EXPECT_EQ(refusal_of([&] { on_disk(comm, folder, faulty, 0); }), in_memory);
}

} // namespace
} // namespace dovetail::testing
