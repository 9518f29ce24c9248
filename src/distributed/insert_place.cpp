// Where new points go: to their slabs, and there between the sites that are there.
#include "insertion.hpp"

#include "dovetail/comm/collectives.hpp"
#include "dovetail/mesh/checksum.hpp"
#include "dovetail/mesh/divide_and_conquer.hpp"
#include "slab_borders.hpp"
#include "sort_points.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <optional>
#include <tuple>

namespace dovetail::insertion {
namespace {

/// The total order cut into slabs: a point that is not less than borders[s - 1] is in slab s or later.
struct Borders {
  TotalOrder less;
  std::vector<Point> keys;

  std::size_t slab_of(Point p) const {
    return at(std::upper_bound(keys.begin(), keys.end(), p, less) - keys.begin());
  }
  /// The first of ascending points that is in slab s or later.
  template <class Iterator, class PointOf>
  Iterator begin_of(std::size_t s, Iterator first, Iterator last, PointOf &&point_of) const {
    if (s == 0)
      return first;
    return std::partition_point(first, last,
                                [&](const auto &item) { return less(point_of(item), keys[s - 1]); });
  }
};

/// A slab's first site, if it has sites.
struct FirstSite {
  Point point;
  std::int64_t any;
};

/// Collective. A point right of a line is right of the border, one left of it is left. Points on the line go
/// where the total order has them: before the first site behind the border or not; if that is not on the
/// line, before it.
Borders borders_of(const Communicator &comm, const DistributedMesh &mesh) {
  const auto own = collectively(comm, [&] {
    std::vector<FirstSite> firsts;
    firsts.reserve(mesh.slabs.size());
    for (const SlabMesh &slab : mesh.slabs)
      firsts.push_back(slab.own_count > 0 ? FirstSite{slab.vertices.points.front(), 1}
                                          : FirstSite{{0, 0}, 0});
    return firsts;
  });
  const std::vector<FirstSite> firsts = all_gather_bulk<FirstSite>(comm, own).data;
  return collectively(comm, [&] {
    const Axis axis = mesh.axis;
    Borders borders{TotalOrder{axis}, std::vector<Point>(mesh.lines.size())};
    std::optional<Point> next;
    for (std::size_t s = firsts.size(); s-- > 1;) {
      if (firsts[s].any != 0)
        next = firsts[s].point;
      const double line = mesh.lines[s - 1];
      const double from =
          next && across(*next, axis) == line ? along(*next, axis) : std::numeric_limits<double>::infinity();
      borders.keys[s - 1] = axis == Axis::x ? Point{line, from} : Point{from, line};
      if (!std::isfinite(line) || (next && across(*next, axis) < line))
        refuse_mesh(fmt::format("slab {}", s), "has sites left of its left line");
    }
    if (!std::is_sorted(borders.keys.begin(), borders.keys.end(), borders.less))
      refuse_mesh("lines", "do not ascend");
    return borders;
  });
}

/// Collective. The last index that a point of the mesh's own input can have had.
GlobalIndex last_index(const Communicator &comm, const DistributedMesh &mesh) {
  GlobalIndex highest = mesh.digest.points - 1;
  for (const SlabMesh &slab : mesh.slabs) {
    // Hardly ever is one higher, which is found out for all at the speed of memory: by the sign of what lies
    // between. A negative index, as no sound mesh has it, may seem higher and does no harm.
    const std::vector<GlobalIndex> &indices = slab.vertices.input_index;
    std::uint64_t distances = 0;
    for (const GlobalIndex index : indices)
      distances |= static_cast<std::uint64_t>(highest) - static_cast<std::uint64_t>(index);
    if (distances >> 63 != 0)
      highest = std::max(highest, std::ranges::max(indices));
  }
  for (const Duplicate &duplicate : mesh.duplicates)
    highest = std::max(highest, duplicate.input_index);
  return all_reduce_max(comm, highest);
}

/// Collective. Numbers the points behind those of the mesh, adds them to its digest and returns the number of
/// the first.
GlobalIndex continue_input(const Communicator &comm, PointTable &points, DistributedMesh &mesh) {
  const GlobalIndex merged = all_reduce_sum(comm, static_cast<GlobalIndex>(mesh.duplicates.size()));
  if (mesh.digest.points != mesh.site_count() + merged)
    refuse_mesh("digest", fmt::format("is of {} points, and not of {} sites and {} duplicates",
                                      mesh.digest.points, mesh.site_count(), merged));
  const GlobalIndex last = last_index(comm, mesh);
  const GlobalIndex beyond = points.input_index.empty() ? 0 : std::ranges::max(points.input_index) + 1;
  if (last > std::numeric_limits<GlobalIndex>::max() - 1 - all_reduce_max(comm, beyond))
    refuse_mesh("input indices", fmt::format("end with {} and leave no room for more", last));
  const GlobalIndex first = last + 1;
  const std::vector<double> *z = heights_of(points);
  std::uint64_t hash = 0;
  for (std::size_t i = 0; i < points.points.size(); ++i) {
    points.input_index[i] += first;
    hash += digest_of_point(points.points[i], z != nullptr ? (*z)[i] : 0.0, points.input_index[i]);
  }
  mesh.digest.points += all_reduce_sum(comm, static_cast<GlobalIndex>(points.points.size()));
  mesh.digest.hash += all_reduce_sum(comm, hash);
  return first;
}

/// How many of this rank's ascending items go to each rank.
template <class Items, class PointOf>
std::vector<std::int64_t> counts_for_ranks(const Communicator &comm, const DistributedMesh &mesh,
                                           const Borders &borders, const Items &items, PointOf &&point_of) {
  std::vector<std::int64_t> counts;
  auto begin = items.begin();
  for (int rank = 0; rank < comm.size(); ++rank) {
    const int beyond = first_slab_of_rank(mesh.slab_count(), rank + 1, comm.size());
    const auto end =
        rank + 1 == comm.size() ? items.end() : borders.begin_of(at(beyond), begin, items.end(), point_of);
    counts.push_back(end - begin);
    begin = end;
  }
  return counts;
}

/// Collective. Sorted distinct points come to the rank that owns their slab; what was merged on the way comes
/// there as well.
std::vector<MergedPoint> bring_to_slabs(const Communicator &comm, const DistributedMesh &mesh,
                                        const Borders &borders, DuplicateRule rule, const Progress &progress,
                                        PointTable &points) {
  const auto purpose = [&] { return fmt::format("sorting {} points", points.points.size()); };
  std::vector<MergedPoint> merged;
  collectively(comm, purpose, [&] {
    sort_points(points, mesh.axis, progress);
    merge_equal_points(points, rule, merged);
  });
  if (comm.size() == 1)
    return merged;
  const auto counts = collectively(
      comm, [&] { return counts_for_ranks(comm, mesh, borders, points.points, [](Point p) { return p; }); });
  const auto merged_counts = collectively(comm, [&] {
    return counts_for_ranks(comm, mesh, borders, merged, [](const MergedPoint &m) { return m.point; });
  });
  redistribute(comm, points, mesh.axis, counts);
  merged = exchange<MergedPoint>(comm, merged, merged_counts).data;
  collectively(comm, purpose, [&] { merge_equal_points(points, rule, merged); });
  return merged;
}

/// Moves row `from` of a table to row `to`.
void move_row(PointTable &table, std::size_t from, std::size_t to) {
  table.points[to] = table.points[from];
  table.input_index[to] = table.input_index[from];
  for (Attribute &attribute : table.attributes)
    attribute.values[to] = attribute.values[from];
}

void shorten(PointTable &table, std::size_t rows) {
  table.points.resize(rows);
  table.input_index.resize(rows);
  for (Attribute &attribute : table.attributes)
    attribute.values.resize(rows);
}

/// New point `row` equals vertex v: one of them represents both, and the other is returned.
MergedPoint settle_equal(PointTable &points, std::size_t row, DuplicateRule rule, PointTable &vertices,
                         std::size_t v) {
  const std::vector<double> *z = heights_of(points);
  const double new_z = z != nullptr ? (*z)[row] : 0.0;
  const double old_z = z != nullptr ? (*heights_of(vertices))[v] : 0.0;
  const bool takes_over =
      (rule == DuplicateRule::lowest && new_z < old_z) || (rule == DuplicateRule::highest && new_z > old_z);
  if (!takes_over)
    return {points.points[row], points.input_index[row], new_z};
  const MergedPoint replaced{points.points[row], vertices.input_index[v], old_z};
  vertices.input_index[v] = points.input_index[row];
  for (std::size_t a = 0; a < vertices.attributes.size(); ++a)
    vertices.attributes[a].values[v] = points.attributes[a].values[row];
  return replaced;
}

/// The first of ascending sites that is not less: near to the beginning in few steps.
std::size_t first_not_less(std::span<const Point> sites, Point p, TotalOrder less) {
  std::size_t low = 0, step = 1;
  for (; low + step < sites.size() && less(sites[low + step], p); step *= 2)
    low += step;
  const auto near = sites.subspan(low, std::min(step + 1, sites.size() - low));
  return low + at(std::ranges::lower_bound(near, p, less) - near.begin());
}

/// The same for each of ascending points. Some searches go on side by side, between the places of the first
/// and the last of them: one alone would wait for memory at every step.
std::vector<std::size_t> first_not_less(std::span<const Point> sites, std::span<const Point> points,
                                        TotalOrder less) {
  constexpr std::size_t side_by_side = 16; // as many as memory answers at a time
  std::vector<std::size_t> places;         // so many sites are known to be less
  places.reserve(points.size());
  std::size_t low = 0;
  for (std::size_t begin = 0; begin < points.size(); begin = places.size()) {
    const auto group = points.subspan(begin, std::min(side_by_side, points.size() - begin));
    const std::size_t high = first_not_less(sites.subspan(low), group.back(), less);
    places.resize(begin + group.size(), low);
    for (std::size_t left = high; left > 0;) {
      const std::size_t half = (left + 1) / 2;
      for (std::size_t i = 0; i < group.size(); ++i) {
        std::size_t &place = places[begin + i];
        place += half * static_cast<std::size_t>(less(sites[place + half - 1], group[i]));
      }
      left -= half;
    }
    low += high;
  }
  return places;
}

/// Local. Finds the new sites among this rank's points, which are sorted and distinct.
Placement find_new_sites(PointTable &&points, const Borders &borders, DuplicateRule rule,
                         DistributedMesh &mesh, std::vector<MergedPoint> &merged) {
  Placement placement;
  placement.sites = std::move(points);
  PointTable &table = placement.sites;
  std::size_t kept = 0, row = 0;
  for (std::size_t k = 0; k < mesh.slabs.size(); ++k) {
    SlabMesh &slab = mesh.slabs[k];
    placement.begins.push_back(kept);
    const auto own = std::span(std::as_const(slab).vertices.points).first(at(slab.own_count));
    const std::size_t beyond = at(mesh.first_slab) + k + 1;
    const auto rows = std::span(std::as_const(table.points)).subspan(row);
    const auto end = beyond <= borders.keys.size()
                         ? std::ranges::lower_bound(rows, borders.keys[beyond - 1], borders.less)
                         : rows.end();
    for (const std::size_t place : first_not_less(own, {rows.begin(), end}, borders.less)) {
      const Point p = table.points[row];
      if (place < own.size() && own[place] == p) {
        merged.push_back(settle_equal(table, row, rule, slab.vertices, place));
      } else {
        move_row(table, row, kept++);
        placement.places.push_back(static_cast<LocalIndex>(place));
      }
      ++row;
    }
  }
  placement.begins.push_back(kept);
  shorten(table, kept);
  return placement;
}

/// Collective. All ranks learn how many sites every slab will have; none may have too many.
void count_sites(const Communicator &comm, const DistributedMesh &mesh, const std::string &points_name,
                 Placement &placement) {
  const auto own = collectively(comm, [&] {
    std::vector<GlobalIndex> counts;
    for (std::size_t k = 0; k < mesh.slabs.size(); ++k)
      counts.push_back(mesh.slabs[k].own_count + static_cast<GlobalIndex>(placement.count(k)));
    return counts;
  });
  const std::vector<GlobalIndex> counts = all_gather_bulk<GlobalIndex>(comm, own).data;
  const auto largest = std::ranges::max_element(counts);
  if (*largest > static_cast<GlobalIndex>(most_delaunay_sites))
    throw Error({ErrorKind::resource, points_name, "",
                 fmt::format("slab {} would have {} sites, more than the {} that one slab can have",
                             largest - counts.begin(), *largest, most_delaunay_sites),
                 "triangulate all points anew, which makes the slabs even"});
  collectively(comm, [&] {
    placement.site_offsets.assign(counts.size() + 1, 0);
    std::partial_sum(counts.begin(), counts.end(), placement.site_offsets.begin() + 1);
  });
}

/// The number that the site at p will have. There is one.
GlobalIndex number_at(Point p, const Borders &borders, const DistributedMesh &mesh,
                      const Placement &placement) {
  const std::size_t s = borders.slab_of(p), k = s - at(mesh.first_slab);
  const std::span<const Point> added = placement.points(k);
  const auto found = std::lower_bound(added.begin(), added.end(), p, borders.less);
  const SlabArrivals arrivals = placement.arrivals(k);
  if (found != added.end() && *found == p)
    return placement.site_offsets[s] + arrivals.place_of_new(at(found - added.begin()));
  const SlabMesh &slab = mesh.slabs[k];
  const auto own = std::span(slab.vertices.points).first(at(slab.own_count));
  const auto v = std::ranges::lower_bound(own, p, borders.less) - own.begin();
  return placement.site_offsets[s] + arrivals.place_of_old(static_cast<LocalIndex>(v));
}

/// Local. The duplicates of the larger mesh, with the numbers that sites will have.
void add_duplicates(const std::vector<MergedPoint> &merged, const Borders &borders,
                    const Placement &placement, DistributedMesh &mesh) {
  std::vector<Duplicate> &all = mesh.duplicates;
  for (Duplicate &duplicate : all) {
    const std::size_t s = at(slab_of_site(mesh, duplicate.site)), k = s - at(mesh.first_slab);
    const auto v = static_cast<LocalIndex>(duplicate.site - mesh.site_offsets[s]);
    duplicate.site = placement.site_offsets[s] + placement.arrivals(k).place_of_old(v);
  }
  const auto old_count = std::ssize(all);
  for (const MergedPoint &point : merged)
    all.push_back({point.input_index, number_at(point.point, borders, mesh, placement), point.z});
  const auto less = [](const Duplicate &a, const Duplicate &b) {
    return std::tuple(a.site, a.input_index) < std::tuple(b.site, b.input_index);
  };
  std::sort(all.begin() + old_count, all.end(), less);
  std::inplace_merge(all.begin(), all.begin() + old_count, all.end(), less);
}

/// Collective. Under DuplicateRule::error the merged point that comes first in the input is the fault.
void refuse_equal_points(const Communicator &comm, const std::vector<MergedPoint> &merged,
                         const std::string &points_name, GlobalIndex first_index) {
  const auto first_here = std::ranges::min_element(merged, {}, &MergedPoint::input_index);
  const GlobalIndex here =
      first_here != merged.end() ? first_here->input_index : std::numeric_limits<GlobalIndex>::max();
  const GlobalIndex first = all_reduce_min(comm, here);
  std::optional<Problem> problem;
  if (first_here != merged.end() && here == first)
    problem = Problem{ErrorKind::input, points_name, fmt::format("point {}", here - first_index),
                      fmt::format("equals a site of the mesh or another point: it is at ({}, {})",
                                  first_here->point.x, first_here->point.y),
                      "say which one represents both: --duplicates first, lowest or highest"};
  agree(comm, problem);
}

} // namespace

Placement place_points(const Communicator &comm, PointTable &&points, const InsertOptions &options,
                       DistributedMesh &mesh) {
  const Borders borders = borders_of(comm, mesh);
  const GlobalIndex first_index = continue_input(comm, points, mesh);
  std::vector<MergedPoint> merged =
      bring_to_slabs(comm, mesh, borders, options.duplicates, options.progress, points);
  Placement placement = collectively(
      comm, [&] { return find_new_sites(std::move(points), borders, options.duplicates, mesh, merged); });
  if (options.duplicates == DuplicateRule::error)
    refuse_equal_points(comm, merged, options.points_name, first_index);
  count_sites(comm, mesh, options.points_name, placement);
  collectively(comm, [&] { add_duplicates(merged, borders, placement, mesh); });
  return placement;
}

} // namespace dovetail::insertion
