// What cannot be written or read ends as one Error on all ranks, and leaves nothing behind.
#include "support/mesh_oracle.hpp"
#include "support/temporary_folder.hpp"

#include "dovetail/comm/collectives.hpp"
#include "dovetail/distributed/validate.hpp"
#include "dovetail/io/mesh.hpp"

#include <boost/mpi/communicator.hpp>
#include <gtest/gtest.h>
#include <hdf5.h>

#include <csignal>
#include <fstream>
#include <functional>
#include <optional>
#include <random>

#include <sys/resource.h>
#include <sys/stat.h>

using namespace dovetail;
using dovetail::testing::TemporaryFolder;

namespace {

Communicator world() { return Communicator::duplicate(boost::mpi::communicator()); }

DistributedMesh test_mesh(const Communicator &comm, int points = 300) {
  return oracle::make_mesh(oracle::table_of(oracle::random_points(points, 1)),
                           {5, Axis::x, comm.rank(), comm.size()});
}

/// Collective: what `work` ended with on this rank; that all ranks ended alike is expected here.
std::optional<Problem> problem_of(const Communicator &comm, const std::function<void()> &work) {
  std::optional<Problem> problem;
  std::string text;
  try {
    work();
  } catch (const Error &error) {
    problem = error.problem();
    text = error.what();
  }
  std::string of_root = text;
  broadcast(comm, of_root);
  EXPECT_EQ(text, of_root);
  return problem;
}

/// Collective: `work` must end with an Error that names the file and says `word`.
void expect_refusal(const Communicator &comm, const std::string &path, const std::string &word,
                    const std::function<void()> &work) {
  const std::optional<Problem> problem = problem_of(comm, work);
  EXPECT_TRUE(problem.has_value()) << "expected: " << word;
  if (!problem)
    return;
  const std::string text = Error(*problem).what();
  EXPECT_NE(text.find(path), std::string::npos) << text;
  EXPECT_NE(text.find(word), std::string::npos) << text;
  EXPECT_FALSE(problem->remedy.empty()) << text;
}

/// The file size limit of this process, while it lives.
class FileSizeLimit {
public:
  explicit FileSizeLimit(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    ::setrlimit(RLIMIT_FSIZE, &limit);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    (void)std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit &) = delete;
  FileSizeLimit &operator=(const FileSizeLimit &) = delete;

private:
  rlimit before_{};
  void (*handler_)(int) = SIG_DFL;
};

} // namespace

TEST(VtkHdfFailures, PlacesThatCannotBeWritten) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const DistributedMesh mesh = test_mesh(comm);
  if (comm.is_root()) {
    std::ofstream(folder.file("file")) << "x";
    std::filesystem::create_directory(folder.file("folder.vtkhdf"));
    EXPECT_EQ(::mkfifo(folder.file("pipe.vtkhdf").c_str(), 0600), 0);
  }
  MPI_Barrier(comm.raw());
  const auto expect = [&](const std::string &path, const std::string &word) {
    expect_refusal(comm, path, word, [&] { write_mesh(comm, mesh, path); });
    EXPECT_FALSE(std::filesystem::exists(path + ".partial"));
  };
  expect(folder.file("missing/mesh.vtkhdf"), "No such file or directory");
  expect(folder.file("file/mesh.vtkhdf"), "Not a directory");
  expect(folder.file("folder.vtkhdf"), "Is a directory");
  expect(folder.file("pipe.vtkhdf"), "is a device");
  expect("/proc/mesh.vtkhdf", "cannot be written");
}

TEST(VtkHdfFailures, FileSizeLimits) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const DistributedMesh mesh = test_mesh(comm, 1000);
  const std::string path = folder.file("mesh.vtkhdf");
  write_mesh(comm, mesh, path);
  const auto size = std::filesystem::file_size(path);
  MPI_Barrier(comm.raw());
  if (comm.is_root())
    std::filesystem::remove(path);
  for (const auto limit :
       {std::uintmax_t{0}, std::uintmax_t{1000}, std::uintmax_t{20000}, size / 2, size - 1}) {
    SCOPED_TRACE(limit);
    expect_refusal(comm, path, "file size limit", [&] {
      const FileSizeLimit limited(limit);
      write_mesh(comm, mesh, path);
    });
    MPI_Barrier(comm.raw());
    EXPECT_TRUE(std::filesystem::is_empty(folder.file("")));
    MPI_Barrier(comm.raw());
  }
  // The first rank sees no limit, so that the file is there at full length when another one's writes fail.
  if (comm.size() == 1)
    return;
  for (const auto limit : {std::uintmax_t{0}, std::uintmax_t{20000}, size / 2}) {
    SCOPED_TRACE(limit);
    expect_refusal(comm, path, "cannot be written", [&] {
      std::optional<FileSizeLimit> limited;
      if (comm.rank() == comm.size() - 1)
        limited.emplace(limit);
      write_mesh(comm, mesh, path);
    });
    MPI_Barrier(comm.raw());
    EXPECT_TRUE(std::filesystem::is_empty(folder.file("")));
    MPI_Barrier(comm.raw());
  }
  write_mesh(comm, mesh, path); // and all is well again
  EXPECT_EQ(read_mesh(comm, path).triangle_count(), mesh.triangle_count());
}

TEST(VtkHdfFailures, AttributeNames) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  for (const char *name : {"", "a/b", ".", "vtkGhostType", "global_number", "z"}) {
    DistributedMesh mesh = test_mesh(comm);
    for (SlabMesh &slab : mesh.slabs)
      slab.vertices.attributes[1].name = name;
    expect_refusal(comm, folder.file("mesh.vtkhdf"), "attribute",
                   [&] { write_mesh(comm, mesh, folder.file("mesh.vtkhdf")); });
    EXPECT_TRUE(std::filesystem::is_empty(folder.file("")));
  }
}

TEST(VtkHdfFailures, FilesThatAreNoMesh) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  if (comm.is_root()) {
    std::ofstream(folder.file("empty.vtkhdf")) << "";
    std::ofstream(folder.file("text.vtkhdf")) << "this is not HDF5\n";
    H5Fclose(H5Fcreate(folder.file("other.vtkhdf").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
  }
  MPI_Barrier(comm.raw());
  const auto expect = [&](const std::string &path, const std::string &word) {
    expect_refusal(comm, path, word, [&] { read_mesh(comm, path); });
    expect_refusal(comm, path, word, [&] { describe_mesh(comm, path); });
  };
  expect(folder.file("missing.vtkhdf"), "No such file or directory");
  expect(folder.file(""), "Is a directory");
  expect(folder.file("empty.vtkhdf"), "is not an HDF5 file");
  expect(folder.file("text.vtkhdf"), "is not an HDF5 file");
  expect(folder.file("other.vtkhdf"), "not a mesh made by dovetail");
}

TEST(VtkHdfFailures, TruncatedFiles) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const DistributedMesh mesh = test_mesh(comm);
  const std::string path = folder.file("mesh.vtkhdf");
  write_mesh(comm, mesh, path);
  for (auto size = std::filesystem::file_size(path); size > 600; size -= size / 4 + 1) {
    MPI_Barrier(comm.raw());
    if (comm.is_root())
      std::filesystem::resize_file(path, size - 1);
    MPI_Barrier(comm.raw());
    expect_refusal(comm, path, "damaged, truncated", [&] { read_mesh(comm, path); });
  }
}

namespace {

/// As `dovetail verify` does: the file stays open, and its slabs are read when it is their turn.
bool is_valid_slab_by_slab(const Communicator &comm, const std::string &path) {
  return validate(comm, *open_mesh(comm, path)).valid;
}

/// Changes to a complete file, made with HDF5 itself.
class Surgery {
public:
  explicit Surgery(const std::string &path) : file_(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT)) {}
  ~Surgery() { H5Fclose(file_); }
  Surgery(const Surgery &) = delete;
  Surgery &operator=(const Surgery &) = delete;

  void drop(const char *name) const { H5Ldelete(file_, name, H5P_DEFAULT); }

  enum class Storage { allocated, promised, chunked };
  void replace(const char *name, hid_t type, std::vector<hsize_t> shape,
               Storage storage = Storage::allocated) const {
    drop(name);
    const hid_t space = H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    const std::vector<hsize_t> chunk(shape.size(), 1);
    if (storage == Storage::allocated)
      H5Pset_alloc_time(properties, H5D_ALLOC_TIME_EARLY);
    if (storage == Storage::chunked)
      H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data());
    H5Dclose(H5Dcreate2(file_, name, type, space, H5P_DEFAULT, properties, H5P_DEFAULT));
    H5Pclose(properties);
    H5Sclose(space);
  }

  /// One of the numbers of a dataset of 64-bit integers.
  std::int64_t row(const char *name, std::size_t row) const {
    const hid_t dataset = H5Dopen2(file_, name, H5P_DEFAULT);
    const hid_t space = H5Dget_space(dataset);
    std::vector<std::int64_t> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    EXPECT_GE(H5Dread(dataset, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0) << name;
    H5Sclose(space);
    H5Dclose(dataset);
    return values.at(row);
  }

  /// Sets one number of a dataset; 64-bit integers only, or whatever HDF5 converts them to.
  void set(const char *name, hsize_t row, std::int64_t value, hsize_t column = 0) const {
    const hid_t dataset = H5Dopen2(file_, name, H5P_DEFAULT);
    const hid_t space = H5Dget_space(dataset);
    const std::vector<hsize_t> coordinates{row, column};
    H5Sselect_elements(space, H5S_SELECT_SET, 1, coordinates.data());
    const hsize_t one = 1;
    const hid_t memory = H5Screate_simple(1, &one, nullptr);
    EXPECT_GE(H5Dwrite(dataset, H5T_NATIVE_INT64, memory, space, H5P_DEFAULT, &value), 0) << name;
    H5Sclose(memory);
    H5Sclose(space);
    H5Dclose(dataset);
  }

  void set_attribute(const char *name, std::int64_t value) const {
    // Not H5Aopen_by_name: in HDF5 1.10.8 an attribute opened so cannot be written.
    const hid_t group = H5Gopen2(file_, "dovetail", H5P_DEFAULT);
    const hid_t attribute = H5Aopen(group, name, H5P_DEFAULT);
    EXPECT_GE(H5Awrite(attribute, H5T_NATIVE_INT64, &value), 0) << name;
    H5Aclose(attribute);
    H5Gclose(group);
  }

  void drop_attribute(const char *object, const char *name) const {
    H5Adelete_by_name(file_, object, name, H5P_DEFAULT);
  }

private:
  hid_t file_;
};

} // namespace

TEST(VtkHdfFailures, FilesThatContradictThemselves) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const DistributedMesh mesh = test_mesh(comm);
  const std::string good = folder.file("good.vtkhdf");
  const std::string bad = folder.file("bad.vtkhdf");
  write_mesh(comm, mesh, good);
  const auto triangles = static_cast<hsize_t>(mesh.triangle_count());
  const auto expect = [&](const std::string &word, const std::function<void(const Surgery &)> &change) {
    SCOPED_TRACE(word);
    MPI_Barrier(comm.raw());
    if (comm.is_root()) {
      std::filesystem::copy_file(good, bad, std::filesystem::copy_options::overwrite_existing);
      change(Surgery(bad));
    }
    MPI_Barrier(comm.raw());
    expect_refusal(comm, bad, word, [&] { read_mesh(comm, bad); });
    expect_refusal(comm, bad, word, [&] { is_valid_slab_by_slab(comm, bad); });
  };
  for (const char *name : {"VTKHDF/Points",
                           "VTKHDF/Connectivity",
                           "VTKHDF/Offsets",
                           "VTKHDF/Types",
                           "VTKHDF/NumberOfPoints",
                           "VTKHDF/NumberOfCells",
                           "VTKHDF/NumberOfConnectivityIds",
                           "VTKHDF/PointData/vtkGhostType",
                           "VTKHDF/PointData/input_index",
                           "VTKHDF/PointData/global_number",
                           "VTKHDF/PointData/intensity",
                           "dovetail/site_offsets",
                           "dovetail/triangle_offsets",
                           "dovetail/path_offsets",
                           "dovetail/duplicate_offsets",
                           "dovetail/own_counts",
                           "dovetail/lines",
                           "dovetail/neighbours",
                           "dovetail/paths",
                           "dovetail/duplicates",
                           "dovetail/duplicate_z",
                           "dovetail/attributes"})
    expect(std::string(name) + ": is missing", [&](const Surgery &file) { file.drop(name); });
  for (const char *name : {"format_version", "program_version", "axis", "checksum", "hull_edges",
                           "digest_points", "digest_hash"})
    expect(std::string("attribute ") + name + ": is missing",
           [&](const Surgery &file) { file.drop_attribute("dovetail", name); });
  expect("not a mesh made by dovetail", [](const Surgery &file) { file.drop("dovetail"); });

  expect("is in mesh format 7", [](const Surgery &file) { file.set_attribute("format_version", 7); });
  expect("there never was", [](const Surgery &file) { file.set_attribute("format_version", -7); });
  expect("another type of number",
         [&](const Surgery &file) { file.replace("VTKHDF/Connectivity", H5T_STD_I64LE, {3 * triangles}); });
  expect("has shape",
         [&](const Surgery &file) { file.replace("dovetail/neighbours", H5T_STD_I64LE, {3 * triangles}); });
  expect("has shape", [&](const Surgery &file) {
    file.replace("dovetail/neighbours", H5T_STD_I64LE, {triangles, 4});
  });
  expect("where the other datasets imply",
         [&](const Surgery &file) { file.replace("VTKHDF/Types", H5T_STD_U8LE, {triangles + 1}); });
  // A promise of a hundred terabytes that occupies nothing: nobody may take memory for it.
  expect("not stored contiguously", [&](const Surgery &file) {
    file.replace("dovetail/paths", H5T_STD_I64LE, {hsize_t{1} << 47}, Surgery::Storage::chunked);
  });
  expect("claims", [&](const Surgery &file) {
    file.replace("dovetail/paths", H5T_STD_I64LE, {hsize_t{1} << 40}, Surgery::Storage::promised);
  });
  expect("falls from", [](const Surgery &file) { file.set("dovetail/site_offsets", 2, 0); });
  expect("does not begin with 0", [](const Surgery &file) { file.set("dovetail/path_offsets", 0, -1); });
  expect("contradicts", [](const Surgery &file) { file.set("dovetail/own_counts", 1, 7); });
  expect("contradicts", [](const Surgery &file) { file.set("VTKHDF/NumberOfPoints", 1, -1); });
  expect("contradicts", [](const Surgery &file) { file.set("VTKHDF/NumberOfCells", 1, 1); });
  expect("contradicts", [](const Surgery &file) { file.set("VTKHDF/NumberOfConnectivityIds", 1, 1); });
  expect("imply", [](const Surgery &file) { file.set("VTKHDF/NumberOfPoints", 1, 100000); });
  expect("Types, row 3: is 9", [](const Surgery &file) { file.set("VTKHDF/Types", 3, 9); });
  expect("Offsets, row 3: is 8", [](const Surgery &file) { file.set("VTKHDF/Offsets", 3, 8); });
  expect("vtkGhostType, row 0", [](const Surgery &file) { file.set("VTKHDF/PointData/vtkGhostType", 0, 1); });
  expect("global_number, row 1",
         [](const Surgery &file) { file.set("VTKHDF/PointData/global_number", 1, 5); });
}

// A slab gets a duplicate that is its neighbour's: all of them together, as a mesh in memory has them, are
// right.
TEST(VtkHdfFailures, DuplicateOfAnotherSlab) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const std::string path = folder.file("mesh.vtkhdf");
  const DistributedMesh mesh = oracle::make_mesh(oracle::table_of(oracle::lattice_points(150, 9, 21)),
                                                 {5, Axis::x, comm.rank(), comm.size()});
  write_mesh(comm, mesh, path);
  read_mesh(comm, path);
  MPI_Barrier(comm.raw());
  if (comm.is_root()) {
    const Surgery file(path);
    const std::int64_t end = file.row("dovetail/duplicate_offsets", 1);
    EXPECT_LT(end, file.row("dovetail/duplicate_offsets", 2));
    file.set("dovetail/duplicate_offsets", 1, end + 1);
  }
  MPI_Barrier(comm.raw());
  expect_refusal(comm, path, "not one of slab 0", [&] { read_mesh(comm, path); });
  expect_refusal(comm, path, "not one of slab 0", [&] { is_valid_slab_by_slab(comm, path); });
}

// Where there is no z, the third column is nobody's: it must be what VTK is to draw, and that is zero.
TEST(VtkHdfFailures, HeightsWithoutZ) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const std::string path = folder.file("mesh.vtkhdf");
  DistributedMesh mesh = test_mesh(comm);
  for (SlabMesh &slab : mesh.slabs)
    slab.vertices.attributes.erase(slab.vertices.attributes.begin());
  write_mesh(comm, mesh, path);
  read_mesh(comm, path);
  MPI_Barrier(comm.raw());
  if (comm.is_root())
    Surgery(path).set("VTKHDF/Points", 5, 7, 2);
  MPI_Barrier(comm.raw());
  expect_refusal(comm, path, "without an attribute z", [&] { read_mesh(comm, path); });
  expect_refusal(comm, path, "without an attribute z", [&] { is_valid_slab_by_slab(comm, path); });
}

// Any byte of a file may be wrong. Whatever comes of it, it comes to all ranks alike, and soon.
TEST(VtkHdfFailures, ScratchedFiles) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const DistributedMesh mesh = test_mesh(comm, 40);
  const std::string path = folder.file("mesh.vtkhdf");
  write_mesh(comm, mesh, path);
  std::string bytes;
  {
    std::ifstream file(path, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(file), {});
  }
  MPI_Barrier(comm.raw());
  std::mt19937_64 random(11);
  const int rounds = std::getenv("DOVETAIL_FULL") != nullptr ? 5000 : 200;
  int refused = 0;
  for (int round = 0; round < rounds; ++round) {
    std::string scratched = bytes;
    for (int i = 0; i < 1 + round % 3; ++i)
      scratched[random() % scratched.size()] ^= static_cast<char>(1 + random() % 255);
    MPI_Barrier(comm.raw());
    if (comm.is_root())
      std::ofstream(path, std::ios::binary | std::ios::trunc) << scratched;
    MPI_Barrier(comm.raw());
    const bool unreadable = problem_of(comm, [&] { read_mesh(comm, path); }).has_value();
    // A slab that contradicts itself ends a check before all of the file is read.
    bool valid = false;
    problem_of(comm, [&] { valid = is_valid_slab_by_slab(comm, path); });
    EXPECT_FALSE(unreadable && valid);
    refused += unreadable;
  }
  EXPECT_GT(refused, rounds / 20);
}
