// Who speaks to whom, seen through the profiling interface of MPI: this program defines the calls that send,
// notes with whom they speak, and passes them on.
#include "dovetail/distributed/regions.hpp"
#include "dovetail/distributed/stitch.hpp"
#include "dovetail/distributed/triangulate_region.hpp"
#include "dovetail/geometry/distributions.hpp"
#include "mpi/pipeline_support.hpp"

#include <gtest/gtest.h>
#include <mpi.h>

namespace dovetail::testing {
namespace {

std::vector<int> world_ranks(MPI_Comm comm) {
  MPI_Group group, all;
  MPI_Comm_group(comm, &group);
  MPI_Comm_group(MPI_COMM_WORLD, &all);
  int size = 0;
  MPI_Group_size(group, &size);
  std::vector<int> own(static_cast<std::size_t>(size)), ranks(own.size());
  for (int r = 0; r < size; ++r)
    own[static_cast<std::size_t>(r)] = r;
  MPI_Group_translate_ranks(group, size, own.data(), all, ranks.data());
  MPI_Group_free(&group);
  MPI_Group_free(&all);
  return ranks;
}

/// What this rank has said since its group first fell into halves, beyond the half that it is in.
struct Record {
  std::vector<int> half;     ///< world ranks of this rank's latest half; empty before the first split
  std::int64_t inside = 0;   ///< calls among ranks of the half
  std::int64_t crossing = 0; ///< calls that any rank of the other half took part in, or was to hear of

  bool in_half(int rank) const { return std::ranges::find(half, rank) != half.end(); }
  void note(const std::vector<int> &partners) {
    if (half.empty())
      return;
    const bool all = std::ranges::all_of(partners, [&](int rank) { return in_half(rank); });
    (all ? inside : crossing) += 1;
  }
};
Record record;

void note_message(MPI_Comm comm, int to) {
  if (!record.half.empty() && to != MPI_PROC_NULL)
    record.note({world_ranks(comm).at(static_cast<std::size_t>(to))});
}
void note_collective(MPI_Comm comm) {
  if (!record.half.empty())
    record.note(world_ranks(comm));
}

} // namespace
} // namespace dovetail::testing

using dovetail::testing::note_collective;
using dovetail::testing::note_message;

// A call that sends to one rank, and one in which all ranks of a communicator take part.
#define MESSAGE(name, parameters, arguments, to)                                                             \
  int MPI_##name parameters {                                                                                \
    note_message(comm, to);                                                                                  \
    return PMPI_##name arguments;                                                                            \
  }
#define COLLECTIVE(name, parameters, arguments)                                                              \
  int MPI_##name parameters {                                                                                \
    note_collective(comm);                                                                                   \
    return PMPI_##name arguments;                                                                            \
  }
// clang-format off
#define SEND (const void *data, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm)
#define ISEND (const void *data, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm, MPI_Request *request)
extern "C" {
MESSAGE(Send, SEND, (data, count, type, to, tag, comm), to)
MESSAGE(Ssend, SEND, (data, count, type, to, tag, comm), to)
MESSAGE(Isend, ISEND, (data, count, type, to, tag, comm, request), to)
MESSAGE(Issend, ISEND, (data, count, type, to, tag, comm, request), to)
COLLECTIVE(Barrier, (MPI_Comm comm), (comm))
COLLECTIVE(Ibarrier, (MPI_Comm comm, MPI_Request *request), (comm, request))
COLLECTIVE(Bcast, (void *data, int count, MPI_Datatype type, int root, MPI_Comm comm), (data, count, type, root, comm))
COLLECTIVE(Gather, (const void *s, int sn, MPI_Datatype st, void *r, int rn, MPI_Datatype rt, int root, MPI_Comm comm),
           (s, sn, st, r, rn, rt, root, comm))
COLLECTIVE(Gatherv, (const void *s, int sn, MPI_Datatype st, void *r, const int *rn, const int *rd, MPI_Datatype rt,
                     int root, MPI_Comm comm), (s, sn, st, r, rn, rd, rt, root, comm))
COLLECTIVE(Allgather, (const void *s, int sn, MPI_Datatype st, void *r, int rn, MPI_Datatype rt, MPI_Comm comm),
           (s, sn, st, r, rn, rt, comm))
COLLECTIVE(Allgatherv, (const void *s, int sn, MPI_Datatype st, void *r, const int *rn, const int *rd, MPI_Datatype rt,
                        MPI_Comm comm), (s, sn, st, r, rn, rd, rt, comm))
COLLECTIVE(Reduce, (const void *s, void *r, int n, MPI_Datatype t, MPI_Op op, int root, MPI_Comm comm),
           (s, r, n, t, op, root, comm))
COLLECTIVE(Allreduce, (const void *s, void *r, int n, MPI_Datatype t, MPI_Op op, MPI_Comm comm), (s, r, n, t, op, comm))
COLLECTIVE(Scan, (const void *s, void *r, int n, MPI_Datatype t, MPI_Op op, MPI_Comm comm), (s, r, n, t, op, comm))
COLLECTIVE(Alltoall, (const void *s, int sn, MPI_Datatype st, void *r, int rn, MPI_Datatype rt, MPI_Comm comm),
           (s, sn, st, r, rn, rt, comm))
COLLECTIVE(Alltoallv, (const void *s, const int *sn, const int *sd, MPI_Datatype st, void *r, const int *rn,
                       const int *rd, MPI_Datatype rt, MPI_Comm comm), (s, sn, sd, st, r, rn, rd, rt, comm))
COLLECTIVE(Comm_dup, (MPI_Comm comm, MPI_Comm *copy), (comm, copy))
// clang-format on

int MPI_Comm_split(MPI_Comm comm, int color, int key, MPI_Comm *part) {
  note_collective(comm);
  const int result = PMPI_Comm_split(comm, color, key, part);
  int before = 0, after = 0;
  MPI_Comm_size(comm, &before);
  MPI_Comm_size(*part, &after);
  if (after < before)
    dovetail::testing::record.half = dovetail::testing::world_ranks(*part);
  return result;
}
}

namespace dovetail::testing {
namespace {

TEST(PipelineTraffic, HalvesExchangeNothingBetweenTheFirstSplitAndTheStitch) {
  const Communicator comm = world();
  const GlobalIndex n = 20'000;
  std::vector<Point> points(static_cast<std::size_t>(n));
  generate_points({Distribution::uniform, n, 1}, 0, points);
  SlabOptions options;
  options.slabs = 2 * comm.size();
  Slabs slabs = sort_into_slabs(comm, deal(comm, points, 1), options);

  record = {};
  Region region = split_into_regions(comm, std::move(slabs));
  EXPECT_EQ(record.half.size(), 1U); // halved down to this rank alone
  EXPECT_EQ(record.crossing, 0);
  EXPECT_GT(record.inside, 0);

  const std::int64_t before = record.inside;
  UnstitchedMesh local = triangulate_region(std::move(region));
  EXPECT_EQ(record.inside, before); // no call at all
  EXPECT_EQ(record.crossing, 0);

  stitch(comm, std::move(local));
  EXPECT_GT(record.crossing, 0); // so such calls are seen
  record = {};
}

} // namespace
} // namespace dovetail::testing
