// Mesh files of every format from inside: the size of buffers does not show, nor does the number of ranks,
// and what a format or a damaged mesh does not allow is refused. What the bytes mean is read in
// end_to_end/outputs.py.
#include "support/mesh_oracle.hpp"
#include "support/refusal.hpp"
#include "support/temporary_folder.hpp"

#include "dovetail/io/mesh.hpp"

#include <boost/mpi/communicator.hpp>
#include <gtest/gtest.h>

using namespace dovetail;
using namespace dovetail::testing;

namespace {

constexpr const char *extensions[] = {".vtkhdf", ".npy",  ".vtu", ".pvtu", ".ply",
                                      ".msh",    ".node", ".ele", ".VTU"};

Communicator world() { return Communicator::duplicate(boost::mpi::communicator()); }

/// Lattice points have duplicates; with `gaps` some input indices are missing, as of skipped records.
DistributedMesh test_mesh(const Communicator &comm, bool gaps) {
  PointTable table = oracle::table_of(oracle::lattice_points(60, 7, 3));
  if (gaps)
    for (GlobalIndex &index : table.input_index)
      index = 3 * index + 2;
  return oracle::make_mesh(table, {.slabs = 4, .rank = comm.rank(), .ranks = comm.size()});
}

/// The files' contents one after the other, on the root.
std::string contents_of(const std::vector<std::string> &files) {
  std::string all;
  for (const std::string &file : files)
    all += content_of(file);
  return all;
}

TEST(MeshOutputs, BuffersAndRanksDoNotShow) {
  const Communicator comm = world();
  for (const bool gaps : {false, true}) {
    const DistributedMesh mesh = test_mesh(comm, gaps);
    const Communicator alone = comm.split(comm.rank());
    const DistributedMesh whole = test_mesh(alone, gaps);
    for (const std::string extension : extensions) {
      const TemporaryFolder one(comm), two(comm), three(comm);
      const std::vector<std::string> files = write_mesh(comm, mesh, one.file("m" + extension));
      const std::vector<std::string> small =
          write_mesh(comm, mesh, two.file("m" + extension), {.buffer_bytes = 200});
      EXPECT_EQ(files.size(), small.size());
      if (comm.is_root()) {
        const std::string expected = contents_of(files);
        EXPECT_FALSE(expected.empty());
        EXPECT_EQ(contents_of(small), expected) << extension;
        EXPECT_EQ(contents_of(write_mesh(alone, whole, three.file("m" + extension))), expected) << extension;
        EXPECT_EQ(mesh_files(one.file("m" + extension)).back(), files.back());
        for (const std::string &file : files)
          EXPECT_FALSE(std::filesystem::exists(file + ".partial"));
      }
    }
  }
}

// Triangle's own column for it, if it can hold the numbers.
TEST(MeshOutputs, BoundaryMarkers) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  for (const double marker : {7.0, 7.5}) {
    DistributedMesh mesh = test_mesh(comm, false);
    for (SlabMesh &slab : mesh.slabs)
      for (Attribute &attribute : slab.vertices.attributes)
        if (attribute.name != "z") {
          attribute.name = "marker";
          attribute.values.assign(attribute.values.size(), marker);
        }
    write_mesh(comm, mesh, folder.file("m.node"));
    const std::string text = content_of(folder.file("m.node"));
    EXPECT_EQ(text.substr(0, text.find('\n')), marker == 7 ? "60 2 1 1" : "60 2 2 0");
    EXPECT_TRUE(text.ends_with(marker == 7 ? " 7\n" : " 7.5\n")) << text;
    MPI_Barrier(comm.raw());
  }
}

TEST(MeshOutputs, ExtensionsThatAreNone) {
  const Communicator comm = world();
  const DistributedMesh mesh = test_mesh(comm, false);
  const TemporaryFolder folder(comm);
  for (const std::string name : {"m.stl", "m", "m.vtk", "m.vtkhdf.gz"})
    expect_refused(comm, ErrorKind::usage, folder.file(name), {".vtkhdf", ".node", " or "},
                   [&] { write_mesh(comm, mesh, folder.file(name)); });
}

TEST(MeshOutputs, MoreThanPlyCanCount) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  DistributedMesh mesh;
  mesh.site_offsets = {0, GlobalIndex{1} << 31};
  mesh.triangle_offsets = {0, GlobalIndex{1} << 32};
  const std::string path = folder.file("m.ply");
  expect_refused(comm, ErrorKind::resource, path, {"32-bit", "4294967296", ".pvtu"},
                 [&] { write_mesh(comm, mesh, path); });
  EXPECT_FALSE(std::filesystem::exists(path + ".partial"));
}

TEST(MeshOutputs, IndicesThatLeadNowhere) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  // Broken on one rank alone; all of them say so.
  const auto refused = [&](const std::string &extension, const auto &damage) {
    DistributedMesh mesh = test_mesh(comm, false);
    if (comm.rank() == comm.size() - 1)
      damage(mesh);
    const std::string path = folder.file("m" + extension);
    expect_refused(comm, ErrorKind::input, path, {"dovetail verify"}, [&] { write_mesh(comm, mesh, path); });
    for (const std::string &file : mesh_files(path)) {
      EXPECT_FALSE(std::filesystem::exists(file));
      EXPECT_FALSE(std::filesystem::exists(file + ".partial"));
    }
    MPI_Barrier(comm.raw());
  };
  if (comm.size() > 4)
    return; // the last rank has a slab of the four on up to so many
  refused(".npy", [](auto &mesh) { mesh.slabs.back().triangles.corners[1] = 1 << 20; });
  refused(".vtu", [](auto &mesh) { mesh.slabs.back().triangles.corners[1] = -1; });
  refused(".ply", [](auto &mesh) { mesh.slabs.back().vertices.attributes[0].values.pop_back(); });
  refused(".msh", [](auto &mesh) { mesh.slabs.back().ghost_number.pop_back(); });
  refused(".pvtu", [](auto &mesh) { mesh.slabs.back().triangles.neighbours.pop_back(); });
  refused(".node", [](auto &mesh) { mesh.slabs.back().vertices.input_index[0] = -5; });
  refused(".node", [](auto &mesh) {
    auto &index = mesh.slabs.back().vertices.input_index;
    index[0] = index[1];
  });
  refused(".node", [](auto &mesh) { mesh.duplicates.push_back({1000, 1 << 20, 0}); });
}

} // namespace
