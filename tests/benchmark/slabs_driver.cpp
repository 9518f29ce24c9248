// Times sort_into_slabs alone: `mpirun -n P slabs_driver DISTRIBUTION N [repetitions]`. Prints one line a
// repetition: wall and processor nanoseconds a point, traffic, and the growth of the peak resident set over
// the table of points.
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/phases.hpp"
#include "dovetail/distributed/slabs.hpp"
#include "dovetail/geometry/distributions.hpp"

#include <boost/mpi/environment.hpp>
#include <fmt/format.h>

#include <cstdlib>
#include <numeric>

using namespace dovetail;

namespace {

PointTable part_of(const SyntheticSet &set, int rank, int ranks) {
  const GlobalIndex begin = set.n * rank / ranks;
  const auto count = static_cast<std::size_t>(set.n * (rank + 1) / ranks - begin);
  PointTable table;
  table.points.resize(count);
  generate_points(set, begin, table.points);
  table.input_index.resize(count);
  std::iota(table.input_index.begin(), table.input_index.end(), begin);
  table.attributes.push_back({"z", std::vector<double>(count, 1.0)});
  return table;
}

} // namespace

int main(int argc, char **argv) {
  boost::mpi::environment environment(argc, argv);
  const Communicator comm = Communicator::duplicate(boost::mpi::communicator());
  const auto distribution = distribution_named(argc > 1 ? argv[1] : "uniform");
  const GlobalIndex n = argc > 2 ? std::atoll(argv[2]) : 10'000'000;
  const int repetitions = argc > 3 ? std::atoi(argv[3]) : 5;
  if (!distribution)
    return 1;
  for (int r = 0; r < repetitions; ++r) {
    PointTable table = part_of({*distribution, n, 1}, comm.rank(), comm.size());
    const std::int64_t before = current_rss_bytes();
    PhaseLog log(comm);
    const Slabs slabs = log.measure("sort", [&] { return sort_into_slabs(comm, std::move(table), {}); });
    const PhaseSummary cost = summarise(comm, log).front();
    const auto growth = all_reduce_max(comm, peak_rss_bytes() - before);
    const double each = 1e9 / static_cast<double>(n);
    if (comm.is_root())
      fmt::print(
          "{} n {} ranks {} slabs {} axis {}: wall {:.1f} ns, cpu {:.1f} ns a point; sent {:.1f} bytes a "
          "point in {} messages; peak + {:.1f} bytes a point of a rank\n",
          argc > 1 ? argv[1] : "uniform", n, comm.size(), slabs.slab_count(),
          slabs.axis == Axis::x ? "x" : "y", cost.wall_max_s * each, cost.cpu_sum_s * each,
          static_cast<double>(cost.bytes_sent) / static_cast<double>(n), cost.messages_sent,
          static_cast<double>(growth) * comm.size() / static_cast<double>(n));
  }
  return 0;
}
