// Times the pipeline from points in memory to a stitched mesh, phase by phase.
//   mpirun -n P pipeline DISTRIBUTION N [SLABS [ROUNDS]]
// Every round makes the same points anew; one line a round and phase: the most wall time and the sum of
// processor time over the ranks, the latter also in ns a point.
#include "dovetail/comm/phases.hpp"
#include "dovetail/distributed/triangulate.hpp"
#include "dovetail/geometry/distributions.hpp"
#include "dovetail/mesh/checksum.hpp"

#include <boost/mpi/environment.hpp>
#include <fmt/core.h>

#include <cstdlib>
#include <numeric>

using namespace dovetail;

namespace {

PointTable own_share(const Communicator &comm, const SyntheticSet &set) {
  const GlobalIndex begin = set.n * comm.rank() / comm.size(), end = set.n * (comm.rank() + 1) / comm.size();
  PointTable table;
  table.points.resize(static_cast<std::size_t>(end - begin));
  generate_points(set, begin, table.points);
  table.input_index.resize(table.points.size());
  std::iota(table.input_index.begin(), table.input_index.end(), begin);
  return table;
}

void print(const std::vector<PhaseSummary> &phases, const DistributedMesh &mesh, GlobalIndex n) {
  double wall = 0;
  for (const PhaseSummary &phase : phases) {
    wall += phase.wall_max_s;
    fmt::print("{:<12} wall {:7.3f} s  cpu {:7.3f} s  {:6.1f} ns/point  sent {:.1f} MB\n", phase.name,
               phase.wall_max_s, phase.cpu_sum_s, 1e9 * phase.cpu_sum_s / static_cast<double>(n),
               1e-6 * static_cast<double>(phase.bytes_sent));
  }
  const MeshStatistics &statistics = mesh.statistics;
  fmt::print(
      "sort to stitch {:.3f} s; {} triangles, {} slabs, own {} path {} candidates {} sites at most on a "
      "rank; checksum {}; peak {:.0f} MB\n",
      wall, mesh.triangle_count(), mesh.slab_count(), statistics.own_sites_max, statistics.path_sites_max,
      statistics.candidate_sites_max, checksum_text(mesh.checksum),
      1e-6 * static_cast<double>(phases.empty() ? 0 : phases.back().peak_rss_max_bytes));
}

} // namespace

int main(int argc, char **argv) {
  const boost::mpi::environment environment(argc, argv);
  const auto distribution = argc > 2 ? distribution_named(argv[1]) : std::nullopt;
  if (!distribution) {
    fmt::print(stderr, "usage: pipeline DISTRIBUTION N [SLABS [ROUNDS]]\n");
    return 2;
  }
  const Communicator comm = Communicator::duplicate(boost::mpi::communicator());
  const SyntheticSet set{*distribution, std::atoll(argv[2]), 1};
  const int rounds = argc > 4 ? std::atoi(argv[4]) : 1;
  for (int round = 0; round < rounds; ++round) {
    PhaseLog log(comm);
    TriangulateOptions options;
    options.slabs.slabs = argc > 3 ? std::atoi(argv[3]) : 0;
    options.phases = &log;
    const DistributedMesh mesh = triangulate(comm, own_share(comm, set), options);
    const std::vector<PhaseSummary> phases = summarise(comm, log);
    if (comm.is_root())
      print(phases, mesh, set.n);
  }
  return 0;
}
