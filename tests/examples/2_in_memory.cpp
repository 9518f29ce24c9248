// Points in memory on every rank to a distributed mesh, and a walk through what a rank then has.
//
//     find_package(dovetail REQUIRED)
//     target_link_libraries(program PRIVATE dovetail::dovetail)
#include <dovetail/comm/collectives.hpp>
#include <dovetail/distributed/ownership.hpp>
#include <dovetail/distributed/triangulate.hpp>
#include <dovetail/mesh/checksum.hpp>

#include <boost/mpi/environment.hpp>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

/// Every rank computes its own share of a spiral of so many points, here every P-th of them.
std::vector<dovetail::Point> own_points(const dovetail::Communicator &comm, int count) {
  std::vector<dovetail::Point> points;
  for (int k = comm.rank(); k < count; k += comm.size())
    points.push_back({std::sqrt(k) * std::cos(2.4 * k), std::sqrt(k) * std::sin(2.4 * k)});
  return points;
}

/// What this rank has of the mesh, in numbers that hold for all ranks together.
void look_around(const dovetail::Communicator &comm, const dovetail::DistributedMesh &mesh) {
  std::int64_t inner = 0, border = 0, hull = 0; // sides of triangles
  for (const dovetail::SlabMesh &slab : mesh.slabs) {
    const dovetail::Triangulation &triangles =
        slab.triangles; // as in one process, of the slab's own vertices
    for (dovetail::LocalIndex side = 0; side < 3 * triangles.triangle_count(); ++side) {
      const dovetail::GlobalIndex beyond = dovetail::number_of_neighbour(slab, side);
      if (beyond == dovetail::none)
        ++hull;
      else if (dovetail::rank_of_triangle(mesh, beyond, comm.size()) == comm.rank())
        ++inner;
      else
        ++border;
    }

    // A vertex is one of the slab's own sites, or a ghost: a copy of another slab's site. Both come with
    // their coordinates, their global number, and the place that the point had in the input.
    for (dovetail::LocalIndex v = slab.own_count; v < std::ssize(slab.vertices.points); ++v)
      if (dovetail::number_of_vertex(slab, v) == 0)
        std::printf("rank %d has a ghost of site 0, which is point %d of the input\n", comm.rank(),
                    static_cast<int>(slab.vertices.input_index[static_cast<std::size_t>(v)]));
  }
  std::string text;
  for (const int rank : dovetail::neighbour_ranks(mesh, comm.rank(), comm.size()))
    text.append(" ").append(std::to_string(rank));
  std::printf("rank %d: %zu slabs, %d inner sides, %d to other ranks (%s ), %d on the hull\n", comm.rank(),
              mesh.slabs.size(), static_cast<int>(inner), static_cast<int>(border), text.c_str(),
              static_cast<int>(hull));
}

int main(int argc, char **argv) {
  const boost::mpi::environment environment(argc, argv); // or MPI_Init and MPI_Finalize, as you please
  const auto comm = dovetail::Communicator::duplicate(MPI_COMM_WORLD);
  try {
    const std::vector<dovetail::Point> points = own_points(comm, 10'000);
    const dovetail::DistributedMesh mesh = dovetail::triangulate(comm, points);
    look_around(comm, mesh);
    if (comm.is_root())
      std::printf("%d sites, %d triangles, checksum %s\n", static_cast<int>(mesh.site_count()),
                  static_cast<int>(mesh.triangle_count()), dovetail::checksum_text(mesh.checksum).c_str());

    // What goes wrong on one rank is thrown by all of them, so that nobody waits for ever.
    std::vector<dovetail::Point> broken;
    if (comm.rank() == comm.size() - 1)
      broken.push_back({0, std::nan("")});
    dovetail::triangulate(comm, broken);
  } catch (const dovetail::Error &error) {
    std::printf("rank %d caught: %s\n", comm.rank(), error.what());
    return error.kind() == dovetail::ErrorKind::input ? 0 : 1;
  }
  return 1;
}
