#include "choose_axis.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/exchange.hpp"
#include "dovetail/geometry/split_path.hpp"
#include "point_sketch.hpp"

#include <algorithm>
#include <cstdint>
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

namespace {

/// Of the lengths of paths at cuts along x and along y.
Axis better_axis(std::size_t along_x, std::size_t along_y) {
  return 2 * along_y <= along_x && along_y > 0 ? Axis::y : Axis::x;
}

const char *purpose_text() { return "a sample of the points"; }

/// A hash up to which the sketches have `wanted` points together and hardly more; the largest if they have
/// fewer.
std::uint64_t limit_for(const Communicator &comm, PointSketch &sketch, GlobalIndex wanted) {
  std::uint64_t low = 0, high = ~std::uint64_t{0}; // up to low there are too few
  GlobalIndex count = all_reduce_sum(comm, sketch.count_up_to(high));
  while (count > wanted + wanted / 8 && high - low > 1) {
    const std::uint64_t middle = low + (high - low) / 2;
    const GlobalIndex to_middle = all_reduce_sum(comm, sketch.count_up_to(middle));
    if (to_middle < wanted) {
      low = middle;
    } else {
      high = middle;
      count = to_middle;
    }
  }
  return high;
}

/// In each round every second of the ranks that are left gives its sketch to the one before and is done.
PointSketch united_at_root(const Communicator &comm, PointSketch sketch) {
  for (int step = 1; step < comm.size(); step *= 2) {
    std::vector<Point> given;
    const auto letters = collectively(comm, purpose_text, [&] {
      std::vector<Outgoing<Point>> result;
      if (comm.rank() % (2 * step) == step) {
        given = sketch.points();
        result.push_back({comm.rank() - step, given});
      }
      return result;
    });
    const auto arrived = sparse_exchange<Point>(comm, letters);
    collectively(comm, purpose_text, [&] {
      for (const Incoming<Point> &letter : arrived)
        sketch.add(letter.data);
    });
  }
  return sketch;
}

/// Collective. The sketches of all ranks as one, on the root; elsewhere nothing.
std::vector<Point> sample_at_root(const Communicator &comm, PointSketch sketch) {
  // One rank of many has a small part of the sample and need not send more, but for points that others have
  // too.
  for (auto wanted = static_cast<GlobalIndex>(sketch.size());; wanted *= 2) {
    const std::uint64_t limit = limit_for(comm, sketch, wanted);
    PointSketch all =
        united_at_root(comm, collectively(comm, purpose_text, [&] { return sketch.up_to(limit); }));
    std::vector<Point> sample = collectively(
        comm, purpose_text, [&] { return comm.is_root() ? all.points() : std::vector<Point>(); });
    if (any_of_ranks(comm, sample.size() == sketch.size()) || limit == ~std::uint64_t{0})
      return sample;
  }
}

} // namespace

std::vector<Point> sample_of_all(const Communicator &comm, PointSketch sketch) {
  std::vector<Point> sample = sample_at_root(comm, std::move(sketch));
  broadcast_bulk(comm, sample);
  return sample;
}

Axis choose_axis(const std::vector<Point> &sample) {
  return better_axis(quartile_path_sites(sample, Axis::x), quartile_path_sites(sample, Axis::y));
}

/// Of several ranks one judges each axis, and nobody waits for both.
Axis choose_axis(const Communicator &comm, std::span<const Point> points) {
  const std::vector<Point> sample = sample_of_all(comm, collectively(comm, purpose_text, [&] {
                                                    PointSketch sketch(axis_sample_size);
                                                    sketch.add(points);
                                                    return sketch;
                                                  }));
  const int judges[] = {0, comm.size() - 1};
  const auto own = collectively(comm, purpose_text, [&] {
    std::vector<std::uint64_t> lengths;
    for (const Axis axis : {Axis::x, Axis::y}) {
      const bool judges_it = judges[static_cast<std::size_t>(axis)] == comm.rank();
      lengths.push_back(judges_it ? quartile_path_sites(sample, axis) : 0);
    }
    return lengths;
  });
  const std::vector<std::uint64_t> lengths = all_reduce_sum(comm, own);
  return better_axis(lengths[0], lengths[1]);
}

} // namespace dovetail
