#include "choose_axis.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/exchange.hpp"
#include "dovetail/geometry/split_path.hpp"
#include "point_sketch.hpp"

#include <algorithm>
#include <utility>

namespace dovetail {

std::size_t quartile_path_sites(std::vector<Point> sites, Axis axis) {
  if (sites.empty())
    return 0;
  std::vector<PathSite> ascending;
  ascending.reserve(sites.size());
  const Axis other = axis == Axis::x ? Axis::y : Axis::x;
  std::sort(sites.begin(), sites.end(), TotalOrder{other});
  for (const Point &site : sites)
    ascending.push_back({site, 0});
  std::size_t length = 0;
  for (const std::size_t quarter : {1u, 2u, 3u}) {
    const auto at = sites.begin() + static_cast<std::ptrdiff_t>(quarter * sites.size() / 4);
    std::nth_element(sites.begin(), at, sites.end(), TotalOrder{axis});
    length += split_path_of_ascending(ascending, {across(*at, axis), axis}).size();
  }
  return length;
}

Axis choose_axis(std::vector<Point> sample) {
  const std::size_t along_y = quartile_path_sites(sample, Axis::y);
  return 2 * along_y <= quartile_path_sites(std::move(sample), Axis::x) && along_y > 0 ? Axis::y : Axis::x;
}

std::vector<Point> sample_of_all(const Communicator &comm, PointSketch sketch) {
  const auto purpose = [] { return "a sample of the points"; };
  // In each round every second of the ranks that are left gives its sketch to the one before and is done.
  for (int step = 1; step < comm.size(); step *= 2) {
    std::vector<Point> given;
    const auto letters = collectively(comm, purpose, [&] {
      std::vector<Outgoing<Point>> result;
      if (comm.rank() % (2 * step) == step) {
        given = sketch.points();
        result.push_back({comm.rank() - step, given});
      }
      return result;
    });
    const auto arrived = sparse_exchange<Point>(comm, letters);
    collectively(comm, purpose, [&] {
      for (const Incoming<Point> &letter : arrived)
        sketch.add(letter.data);
    });
  }
  std::vector<Point> sample =
      collectively(comm, purpose, [&] { return comm.is_root() ? sketch.points() : std::vector<Point>(); });
  broadcast_bulk(comm, sample);
  return sample;
}

Axis choose_axis(const Communicator &comm, std::span<const Point> points) {
  const auto purpose = [] { return "a sample of the points"; };
  std::vector<Point> sample = sample_of_all(comm, collectively(comm, purpose, [&] {
                                              PointSketch sketch(axis_sample_size);
                                              sketch.add(points);
                                              return sketch;
                                            }));
  int axis = collectively(
      comm, purpose, [&] { return comm.is_root() ? static_cast<int>(choose_axis(std::move(sample))) : 0; });
  broadcast(comm, axis);
  return static_cast<Axis>(axis);
}

} // namespace dovetail
