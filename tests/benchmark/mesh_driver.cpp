// Times reading, validating and writing a mesh file.
//
// usage: mpirun -n P mesh_driver MESH.vtkhdf COPY.vtkhdf [ROUNDS]     (the copy is byte for byte the same)
#include "dovetail/comm/collectives.hpp"
#include "dovetail/distributed/validate.hpp"
#include "dovetail/io/mesh.hpp"

#include <boost/mpi/communicator.hpp>
#include <boost/mpi/environment.hpp>
#include <fmt/core.h>

#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <string>

namespace {

using namespace dovetail;

double cpu_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Collective. Runs `work` and tells how long it took.
template <class Work> void time(const Communicator &comm, const char *name, std::int64_t bytes, Work &&work) {
  MPI_Barrier(comm.raw());
  const double wall = MPI_Wtime();
  const double cpu = cpu_seconds();
  work();
  const double cpu_sum = all_reduce_sum(comm, cpu_seconds() - cpu);
  const double wall_max = all_reduce_max(comm, MPI_Wtime() - wall);
  if (comm.is_root())
    fmt::print("{:9} {:8.3f} s wall, {:8.3f} s cpu on all ranks, {:6.0f} MB/s\n", name, wall_max, cpu_sum,
               1e-6 * static_cast<double>(bytes) / wall_max);
}

} // namespace

int main(int argc, char **argv) {
  const boost::mpi::environment environment(argc, argv);
  const Communicator comm = Communicator::duplicate(boost::mpi::communicator());
  if (argc < 3) {
    if (comm.is_root())
      fmt::print(stderr, "usage: {} MESH.vtkhdf COPY.vtkhdf [ROUNDS]\n", argv[0]);
    return 2;
  }
  const auto bytes = static_cast<std::int64_t>(std::filesystem::file_size(argv[1]));
  const int rounds = argc > 3 ? std::atoi(argv[3]) : 1;
  bool valid = true;
  for (int round = 0; round < rounds; ++round) {
    DistributedMesh mesh;
    time(comm, "read", bytes, [&] { mesh = read_mesh(comm, argv[1]); });
    time(comm, "write", bytes, [&] { write_mesh(comm, mesh, argv[2]); });
    time(comm, "validate", bytes, [&] { valid = validate(comm, mesh).valid && valid; });
  }
  return valid ? 0 : 1;
}
