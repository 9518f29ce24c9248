// Triangulates, writes the mesh to the file given and reads it back, and catches an error that all ranks have
// agreed on: a program with its own MPI over all parts of the installed library.
#include <dovetail/distributed/triangulate.hpp>
#include <dovetail/io/mesh.hpp>

#include <boost/mpi/environment.hpp>

#include <cstdio>
#include <vector>

int main(int argc, char **argv) {
  const boost::mpi::environment environment(argc, argv);
  const auto comm = dovetail::Communicator::duplicate(boost::mpi::communicator());
  const std::vector<dovetail::Point> points{{0, 0}, {1, 0}, {0, 1}, {1, 1}, {0.5, 0.25}};
  try {
    write_mesh(comm, dovetail::triangulate(comm, points), argv[1]);
    const dovetail::DistributedMesh mesh = dovetail::read_mesh(comm, argv[1]);
    std::printf("%d sites, %d triangles\n", static_cast<int>(mesh.site_count()),
                static_cast<int>(mesh.triangle_count()));
    dovetail::read_mesh(comm, "no such.vtkhdf");
  } catch (const dovetail::Error &error) {
    std::puts(error.what());
  }
}
