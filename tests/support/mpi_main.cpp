// main() of every MPI test: all ranks run the same tests and agree on the verdict.
// Use EXPECT_ and never ASSERT_ around collectives: a rank that leaves early hangs the others.
#include <boost/mpi/communicator.hpp>
#include <boost/mpi/environment.hpp>
#include <gtest/gtest.h>

int main(int argc, char **argv) {
  boost::mpi::environment environment(argc, argv);
  ::testing::InitGoogleTest(&argc, argv);
  const boost::mpi::communicator world;
  const int failed = RUN_ALL_TESTS();
  int any = 0;
  MPI_Allreduce(&failed, &any, 1, MPI_INT, MPI_MAX, static_cast<MPI_Comm>(world));
  return any;
}
