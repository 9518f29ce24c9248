// Reading and writing tell every rank how much of its own part is done: of every format, never backwards, to
// the end, and in steps as small as buffers.
#include "support/mesh_oracle.hpp"
#include "support/temporary_folder.hpp"

#include "dovetail/io/mesh.hpp"
#include "dovetail/io/points.hpp"

#include <boost/mpi/communicator.hpp>
#include <gtest/gtest.h>

using namespace dovetail;
using namespace dovetail::testing;

namespace {

constexpr std::int64_t small_buffer = 200;
constexpr int count = 400;

Communicator world() { return Communicator::duplicate(boost::mpi::communicator()); }

// What a rank was told of one stage.
class Listener {
public:
  explicit Listener(std::string stage) : stage_(std::move(stage)) {}
  Progress progress() {
    return [this](std::string_view stage, double fraction) {
      EXPECT_EQ(stage, stage_);
      told_.push_back(fraction);
    };
  }
  // `about`: the whole was not known to the byte.
  void expect_all_told(const std::string &what, bool about) const {
    ASSERT_GT(told_.size(), 5u) << what;
    EXPECT_GT(told_.front(), 0) << what;
    EXPECT_LT(told_.front(), 0.5) << what;
    for (std::size_t i = 1; i < told_.size(); ++i)
      EXPECT_GE(told_[i], told_[i - 1]) << what;
    EXPECT_LE(told_.back(), 1) << what;
    EXPECT_GE(told_.back(), about ? 0.8 : 1 - 1e-9) << what;
  }

private:
  std::string stage_;
  std::vector<double> told_;
};

PointTable table_of_rank(const Communicator &comm) {
  const PointTable all = oracle::table_of(oracle::random_points(count, 5));
  PointTable own;
  own.attributes.push_back({"z", {}});
  for (std::size_t i = 0; i < all.points.size(); ++i)
    if (static_cast<int>(i) * comm.size() / count == comm.rank()) {
      own.points.push_back(all.points[i]);
      own.input_index.push_back(all.input_index[i]);
      own.attributes[0].values.push_back(0.1 * static_cast<double>(i));
    }
  return own;
}

TEST(IoProgress, Points) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  for (const PointExtension &each : point_extensions()) {
    if (!each.written)
      continue;
    const std::string extension(each.extension), path = folder.file("p" + extension);
    PointTable table = table_of_rank(comm);
    if (each.format == PointFormat::f64)
      table.attributes.clear();
    for (const std::int64_t kept : {std::int64_t{0}, std::int64_t{1} << 20}) {
      Listener writing("write");
      write_points(comm, table, path, {small_buffer, kept, writing.progress()});
      writing.expect_all_told("writing " + path, false);
    }
    Listener reading("read");
    PointReading how;
    how.buffer_bytes = small_buffer;
    how.progress = reading.progress();
    read_points(comm, std::vector{path, path}, how);
    // The lines of a rank are those that begin in its bytes.
    reading.expect_all_told("reading " + path,
                            each.format == PointFormat::text || each.format == PointFormat::node);
    MPI_Barrier(comm.raw());
  }
}

TEST(IoProgress, Meshes) {
  const Communicator comm = world();
  const TemporaryFolder folder(comm);
  const PointTable table = oracle::table_of(oracle::random_points(count, 5));
  const DistributedMesh mesh =
      oracle::make_mesh(table, {.slabs = comm.size(), .rank = comm.rank(), .ranks = comm.size()});
  for (const char *extension : {".vtkhdf", ".npy", ".vtu", ".pvtu", ".ply", ".msh", ".node", ".ele"}) {
    Listener writing("write");
    const std::string path = folder.file(std::string("m") + extension);
    write_mesh(comm, mesh, path, {small_buffer, writing.progress()});
    writing.expect_all_told("writing " + path, true);
  }
  Listener reading("read");
  read_mesh(comm, folder.file("m.vtkhdf"), reading.progress());
  reading.expect_all_told("reading a mesh", false);
}

TEST(IoProgress, PartsOfStages) {
  std::vector<double> told;
  const Progress all = [&](std::string_view, double fraction) { told.push_back(fraction); };
  report_progress(part_of_stage(all, 0, 0.25), "read", 1);
  ProgressCount done(part_of_stage(all, 0.25, 1), "read", 3);
  for (const double amount : {1.0, 0.0, 1.0, 5.0})
    done.add(amount);
  EXPECT_EQ(told, (std::vector{0.25, 0.5, 0.75, 1.0}));
  EXPECT_FALSE(part_of_stage({}, 0, 1));
  ProgressCount({}, "read", 0).add(1);
}

} // namespace
