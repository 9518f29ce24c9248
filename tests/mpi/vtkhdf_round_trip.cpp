// Meshes go into files and come out again, on any numbers of ranks, and the bytes do not tell how many.
#include "support/mesh_oracle.hpp"
#include "support/temporary_folder.hpp"

#include "dovetail/comm/collectives.hpp"
#include "dovetail/distributed/validate.hpp"
#include "dovetail/io/mesh.hpp"

#include <boost/mpi/communicator.hpp>
#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <fstream>
#include <iterator>
#include <thread>

using namespace dovetail;
using dovetail::testing::TemporaryFolder;

namespace {

template <class T> bool same_bytes(const std::vector<T> &a, const std::vector<T> &b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void expect_same(const PointTable &a, const PointTable &b) {
  EXPECT_TRUE(same_bytes(a.points, b.points));
  EXPECT_EQ(a.input_index, b.input_index);
  EXPECT_EQ(a.attributes.size(), b.attributes.size());
  for (std::size_t i = 0; i < std::min(a.attributes.size(), b.attributes.size()); ++i) {
    EXPECT_EQ(a.attributes[i].name, b.attributes[i].name);
    EXPECT_TRUE(same_bytes(a.attributes[i].values, b.attributes[i].values));
  }
}

void expect_same(const SlabMesh &a, const SlabMesh &b) {
  EXPECT_EQ(a.own_count, b.own_count);
  EXPECT_EQ(a.first_site, b.first_site);
  EXPECT_EQ(a.first_triangle, b.first_triangle);
  expect_same(a.vertices, b.vertices);
  EXPECT_EQ(a.ghost_number, b.ghost_number);
  EXPECT_EQ(a.triangles.corners, b.triangles.corners);
  EXPECT_EQ(a.triangles.neighbours, b.triangles.neighbours);
  EXPECT_EQ(a.left_path, b.left_path);
  EXPECT_EQ(a.border_sides.size(), b.border_sides.size());
  for (std::size_t i = 0; i < std::min(a.border_sides.size(), b.border_sides.size()); ++i) {
    EXPECT_EQ(a.border_sides[i].side, b.border_sides[i].side);
    EXPECT_EQ(a.border_sides[i].neighbour, b.border_sides[i].neighbour);
  }
}

void expect_same(const DistributedMesh &a, const DistributedMesh &b) {
  EXPECT_EQ(a.axis, b.axis);
  EXPECT_EQ(a.site_offsets, b.site_offsets);
  EXPECT_EQ(a.triangle_offsets, b.triangle_offsets);
  EXPECT_EQ(a.lines, b.lines);
  EXPECT_EQ(a.hull_edges, b.hull_edges);
  EXPECT_EQ(a.checksum, b.checksum);
  EXPECT_EQ(a.digest.points, b.digest.points);
  EXPECT_EQ(a.digest.hash, b.digest.hash);
  EXPECT_EQ(a.duplicates, b.duplicates);
  EXPECT_EQ(a.first_slab, b.first_slab);
  EXPECT_EQ(a.coordinate_system.size(), b.coordinate_system.size());
  for (std::size_t i = 0; i < std::min(a.coordinate_system.size(), b.coordinate_system.size()); ++i) {
    EXPECT_EQ(a.coordinate_system[i].user_id, b.coordinate_system[i].user_id);
    EXPECT_EQ(a.coordinate_system[i].record_id, b.coordinate_system[i].record_id);
    EXPECT_EQ(a.coordinate_system[i].description, b.coordinate_system[i].description);
    EXPECT_EQ(a.coordinate_system[i].bytes, b.coordinate_system[i].bytes);
  }
  EXPECT_EQ(a.slabs.size(), b.slabs.size());
  for (std::size_t s = 0; s < std::min(a.slabs.size(), b.slabs.size()); ++s)
    expect_same(a.slabs[s], b.slabs[s]);
}

std::string bytes_of(const std::string &path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

struct Case {
  const char *name;
  PointTable points;
  int slabs;
  Axis axis;
};

std::vector<Case> cases() {
  using oracle::table_of;
  PointTable bare = table_of(oracle::random_points(120, 3)); // no attributes at all
  bare.attributes.clear();
  PointTable odd = table_of(oracle::random_points(60, 4)); // attributes, but no z
  odd.attributes.erase(odd.attributes.begin());
  return {
      {"random", table_of(oracle::random_points(300, 1)), 5, Axis::x},
      {"one slab", table_of(oracle::random_points(100, 2)), 1, Axis::y},
      {"lattice with duplicates", table_of(oracle::lattice_points(300, 9, 5)), 7, Axis::x},
      {"lattice along y", table_of(oracle::lattice_points(200, 9, 6)), 16, Axis::y},
      {"without attributes", bare, 3, Axis::x},
      {"without z", odd, 4, Axis::x},
      {"more slabs than sites", table_of(oracle::random_points(5, 7)), 11, Axis::x},
      {"collinear", table_of({{0, 0}, {1, 1}, {2, 2}, {3, 3}, {4, 4}, {2, 2}}), 3, Axis::x},
      {"two points", table_of({{0, 0}, {1, 1}}), 2, Axis::x},
      {"one point, three times", table_of({{1, 1}, {1, 1}, {1, 1}}), 2, Axis::y},
      {"no points", table_of({}), 2, Axis::x},
  };
}

DistributedMesh mesh_of(const Case &test, const Communicator &comm) {
  DistributedMesh mesh = oracle::make_mesh(test.points, {test.slabs, test.axis, comm.rank(), comm.size()});
  mesh.coordinate_system = {{"LASF_Projection", 34735, "GeoTIFF tags", {1, 2, 0, 255}}, {"", 2112, "", {}}};
  return mesh;
}

Communicator world() { return Communicator::duplicate(boost::mpi::communicator()); }

} // namespace

TEST(VtkHdf, ComesBackAsItWas) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  for (const Case &test : cases()) {
    SCOPED_TRACE(test.name);
    const DistributedMesh mesh = mesh_of(test, comm);
    write_mesh(comm, mesh, folder.file("mesh.vtkhdf"));
    EXPECT_FALSE(std::filesystem::exists(folder.file("mesh.vtkhdf.partial")));
    expect_same(read_mesh(comm, folder.file("mesh.vtkhdf")), mesh);
  }
}

TEST(VtkHdf, BytesDoNotDependOnRanksOrBuffers) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  for (const Case &test : cases()) {
    SCOPED_TRACE(test.name);
    write_mesh(comm, mesh_of(test, comm), folder.file("all.vtkhdf"));
    write_mesh(comm, mesh_of(test, comm), folder.file("small.vtkhdf"), {.buffer_bytes = 40});
    const Communicator alone = comm.split(comm.rank());
    if (comm.is_root())
      write_mesh(alone, mesh_of(test, alone), folder.file("one.vtkhdf"));
    if (comm.is_root()) {
      const std::string bytes = bytes_of(folder.file("all.vtkhdf"));
      EXPECT_GT(bytes.size(), 1000U);
      EXPECT_TRUE(bytes == bytes_of(folder.file("small.vtkhdf")));
      EXPECT_TRUE(bytes == bytes_of(folder.file("one.vtkhdf")));
    }
    // Written by one, read by all.
    MPI_Barrier(comm.raw());
    expect_same(read_mesh(comm, folder.file("one.vtkhdf")), mesh_of(test, comm));
  }
}

// The validator says the same of slabs in memory and of slabs that it reads one at a time, of right meshes
// and of wrong ones.
TEST(VtkHdf, ValidatedSlabBySlab) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const std::string path = folder.file("mesh.vtkhdf");
  const PointTable points = oracle::table_of(oracle::lattice_points(300, 9, 5));
  const PointTable nothing{{}, {}, {{"z", {}}, {"intensity", {}}}};
  for (const bool broken : {false, true}) {
    DistributedMesh mesh = mesh_of({"lattice", points, 7, Axis::x}, comm);
    if (broken && !mesh.slabs.empty() && mesh.first_slab == 0) {
      SlabMesh &slab = mesh.slabs.back();
      slab.vertices.points[1].y += 0.25;     // moved
      slab.vertices.input_index.back() += 1; // a ghost, if there is one
      std::swap(slab.triangles.corners[0], slab.triangles.corners[1]);
    }
    write_mesh(comm, mesh, path);
    const PointTable &own = comm.is_root() ? points : nothing;
    const ValidationReport expected = validate(comm, mesh, own);
    const ValidationReport found = validate(comm, *open_mesh(comm, path), own);
    EXPECT_EQ(found.valid, !broken);
    EXPECT_EQ(found.violations_by_kind, expected.violations_by_kind);
    EXPECT_EQ(found.checksum, expected.checksum);
    EXPECT_EQ(std::tie(found.sites, found.ghosts, found.triangles, found.inner_edges, found.border_edges,
                       found.hull_edges, found.path_edges, found.duplicates, found.input_points),
              std::tie(expected.sites, expected.ghosts, expected.triangles, expected.inner_edges,
                       expected.border_edges, expected.hull_edges, expected.path_edges, expected.duplicates,
                       expected.input_points));
    ASSERT_EQ(found.first_violations.size(), expected.first_violations.size());
    for (std::size_t i = 0; i < found.first_violations.size(); ++i)
      EXPECT_EQ(found.first_violations[i].text, expected.first_violations[i].text);
    MPI_Barrier(comm.raw());
  }
}

TEST(VtkHdf, BytesDoNotDependOnTheTime) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const Case test = cases()[0];
  write_mesh(comm, mesh_of(test, comm), folder.file("now.vtkhdf"));
  std::this_thread::sleep_for(std::chrono::milliseconds(1100)); // HDF5 would note seconds
  write_mesh(comm, mesh_of(test, comm), folder.file("later.vtkhdf"));
  EXPECT_TRUE(bytes_of(folder.file("now.vtkhdf")) == bytes_of(folder.file("later.vtkhdf")));
}

TEST(VtkHdf, ReplacesAnOlderFileAndAForgottenPartialOne) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const Case test = cases()[0];
  if (comm.is_root()) {
    std::ofstream(folder.file("mesh.vtkhdf")) << "old";
    std::ofstream(folder.file("mesh.vtkhdf.partial")) << std::string(1000000, 'x');
  }
  MPI_Barrier(comm.raw());
  write_mesh(comm, mesh_of(test, comm), folder.file("mesh.vtkhdf"));
  expect_same(read_mesh(comm, folder.file("mesh.vtkhdf")), mesh_of(test, comm));
}

TEST(VtkHdf, DescribesItself) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const Case test{"lattice", oracle::table_of(oracle::lattice_points(300, 9, 5)), 7, Axis::x};
  const DistributedMesh mesh = mesh_of(test, comm);
  write_mesh(comm, mesh, folder.file("mesh.vtkhdf"));
  const MeshDescription about = describe_mesh(comm, folder.file("mesh.vtkhdf"));
  EXPECT_EQ(about.format_version, 1);
  EXPECT_FALSE(about.program_version.empty());
  EXPECT_EQ(about.axis, Axis::x);
  EXPECT_EQ(about.slabs, 7);
  EXPECT_EQ(about.sites, mesh.site_count());
  EXPECT_EQ(about.triangles, mesh.triangle_count());
  EXPECT_EQ(about.hull_edges, mesh.hull_edges);
  EXPECT_EQ(about.duplicates, 300 - mesh.site_count());
  EXPECT_EQ(about.checksum, mesh.checksum);
  EXPECT_EQ(about.digest.points, 300);
  EXPECT_EQ(about.digest.hash, mesh.digest.hash);
  EXPECT_EQ(about.lowest, (Point{0, 0}));
  EXPECT_EQ(about.highest, (Point{8, 8}));
  EXPECT_EQ(about.attributes, (std::vector<std::string>{"z", "intensity"}));
  EXPECT_EQ(about.coordinate_system.size(), 2U);
  GlobalIndex ghosts = 0;
  GlobalIndex path_sites = 0;
  for (const SlabMesh &slab : mesh.slabs) {
    ghosts += static_cast<GlobalIndex>(slab.ghost_number.size());
    path_sites += static_cast<GlobalIndex>(slab.left_path.size());
  }
  EXPECT_EQ(about.ghosts, all_reduce_sum(comm, ghosts));
  EXPECT_EQ(about.path_sites, all_reduce_sum(comm, path_sites));
  EXPECT_EQ(about.file_bytes,
            static_cast<std::int64_t>(std::filesystem::file_size(folder.file("mesh.vtkhdf"))));
}
