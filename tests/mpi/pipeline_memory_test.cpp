// The whole way from points to a checked mesh while the memory of one rank gives out, at every place in turn.
#include "dovetail/comm/agreement.hpp"
#include "dovetail/distributed/triangulate.hpp"
#include "dovetail/distributed/validate.hpp"
#include "dovetail/geometry/distributions.hpp"
#include "dovetail/io/mesh.hpp"
#include "mpi/pipeline_support.hpp"
#include "support/failing_allocation.hpp"
#include "support/temporary_folder.hpp"

#include <boost/mpi/environment.hpp>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>

namespace dovetail::testing {
namespace {

/// Where memory gives out: of this many bytes at once, and at which time.
struct Shortage {
  std::size_t at_least;
  std::int64_t which;
};

struct Ending {
  std::string text; ///< of the error; empty if all went well
  bool written = false;
};

Ending run(const Communicator &comm, PointTable points, const std::string &path,
           std::optional<Shortage> shortage) {
  bool written = false;
  TriangulateOptions options;
  options.slabs.slabs = 2 * comm.size();
  const PointTable input = points;
  std::optional<FailingAllocation> failing;
  if (shortage)
    failing.emplace(shortage->at_least, shortage->which);
  try {
    const DistributedMesh mesh = triangulate(comm, std::move(points), options);
    EXPECT_TRUE(validate(comm, mesh, input).valid);
    write_mesh(comm, mesh, path);
    written = true;
    EXPECT_TRUE(validate(comm, read_mesh(comm, path)).valid);
    return {"", written};
  } catch (const Error &error) {
    EXPECT_EQ(error.kind(), ErrorKind::resource) << error.what();
    return {error.what(), written};
  } catch (const std::exception &alone) {
    // Here the others wait for this rank for ever.
    std::fprintf(stderr, "rank %d alone: %s\n", comm.rank(), alone.what());
    boost::mpi::environment::abort(1);
    throw;
  }
}

TEST(PipelineMemory, WhereverItGivesOutAllRanksSayTheSame) {
  Communicator comm = world();
  comm.set_chunk_bytes(500); // what is longer does not go through Boost.MPI, whose memory is its own affair
  const TemporaryFolder folder(comm);
  const std::string path = folder.file("mesh.vtkhdf");
  std::vector<Point> sites(2000);
  generate_points({Distribution::kuzmin, 2000, 1}, 0, sites);
  sites.insert(sites.end(), sites.begin(), sites.begin() + 500); // duplicates
  const PointTable points = deal(comm, sites, 1);
  int failures = 0;
  for (int unlucky = 0; unlucky < comm.size(); unlucky += std::max(1, comm.size() - 1))
    for (std::int64_t which = 0;; ++which) {
      std::optional<Shortage> shortage;
      if (comm.rank() == unlucky)
        shortage = {2000, which};
      const auto [text, written] = run(comm, points, path, shortage);
      const bool struck = shortage && FailingAllocation::has_struck();
      std::string text_of_root = text;
      broadcast(comm, text_of_root);
      EXPECT_EQ(text, text_of_root);
      EXPECT_EQ(std::filesystem::exists(path), written) << text;
      EXPECT_EQ(std::filesystem::exists(path + ".partial"), false) << text;
      MPI_Barrier(comm.raw());
      if (comm.is_root())
        std::filesystem::remove(path);
      if (!any_of_ranks(comm, struck)) {
        EXPECT_EQ(text, "");
        break;
      }
      EXPECT_TRUE(text.starts_with("rank " + std::to_string(unlucky) + ": out of memory for ")) << text;
      ++failures;
    }
  EXPECT_GT(failures, 50);
}

} // namespace
} // namespace dovetail::testing
