#include "dovetail/distributed/slabs.hpp"

#include "choose_axis.hpp"
#include "cut_slabs.hpp"
#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/exchange.hpp"
#include "dovetail/mesh/checksum.hpp"
#include "slab_borders.hpp"
#include "sort_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace dovetail {

namespace {

std::size_t index(std::int64_t value) { return static_cast<std::size_t>(value); }

InputDigest digest_of(const Communicator &comm, const PointTable &table) {
  const std::vector<double> *z = heights_of(table);
  std::uint64_t hash = 0;
  for (std::size_t i = 0; i < table.points.size(); ++i)
    hash += digest_of_point(table.points[i], z != nullptr ? (*z)[i] : 0.0, table.input_index[i]);
  return {all_reduce_sum(comm, static_cast<GlobalIndex>(table.points.size())), all_reduce_sum(comm, hash)};
}

/// The first and last point of a rank that has any.
struct Ends {
  Point first;
  Point last;
  std::int64_t count;
};

std::vector<Ends> ends_of_ranks(const Communicator &comm, const std::vector<Point> &points) {
  const Ends own =
      points.empty() ? Ends{{0, 0}, {0, 0}, 0} : Ends{points.front(), points.back(), std::ssize(points)};
  return all_gather(comm, own);
}

/// Refuses points that do not ascend as promised.
void check_presorted(const Communicator &comm, const PointTable &table, Axis axis,
                     const std::string &subject) {
  const TotalOrder less{axis};
  const std::vector<Ends> ends = ends_of_ranks(comm, table.points);
  std::optional<Point> before;
  for (int rank = 0; rank < comm.rank(); ++rank)
    if (ends[index(rank)].count > 0)
      before = ends[index(rank)].last;
  auto offending = std::is_sorted_until(table.points.begin(), table.points.end(), less);
  if (before && !table.points.empty() && less(table.points.front(), *before))
    offending = table.points.begin();
  std::optional<Problem> problem;
  if (offending != table.points.end())
    problem =
        Problem{ErrorKind::input, subject,
                fmt::format("point {}", table.input_index[index(offending - table.points.begin())]),
                fmt::format("the points are not sorted by {} as promised: ({}, {}) comes after a larger one",
                            axis == Axis::x ? "(x, y)" : "(y, x)", offending->x, offending->y),
                "leave --presorted away and they are sorted"};
  agree(comm, problem);
}

std::vector<std::int64_t> differences(std::span<const std::int64_t> offsets) {
  std::vector<std::int64_t> result;
  for (std::size_t i = 0; i + 1 < offsets.size(); ++i)
    result.push_back(offsets[i + 1] - offsets[i]);
  return result;
}

/// Brings sorted points to where they belong if no rank has a point equal to one of another, and equal
/// points to one rank in any case.
void bring_together(const Communicator &comm, PointTable &table, Axis axis, const SlabOptions &options) {
  const auto total = all_reduce_sum(comm, static_cast<GlobalIndex>(table.points.size()));
  const Division division = division_of(comm, total, options.slabs);
  redistribute(comm, table, axis, differences(cut_positions(comm, table.points, axis, division.rank_begins)));
}

/// Moves sorted distinct sites so that every rank has those of its share exactly.
void shift(const Communicator &comm, PointTable &table, Axis axis,
           const std::vector<GlobalIndex> &rank_begins) {
  const auto count = static_cast<GlobalIndex>(table.points.size());
  const GlobalIndex begin = exclusive_scan(comm, count);
  std::vector<std::int64_t> cuts;
  cuts.reserve(rank_begins.size());
  for (const GlobalIndex rank_begin : rank_begins)
    cuts.push_back(std::clamp<GlobalIndex>(rank_begin - begin, 0, count));
  redistribute(comm, table, axis, differences(cuts));
}

/// Sends every merged point to the rank of its site, where it learns the site's number.
std::vector<Duplicate> duplicates_of(const Communicator &comm, const Slabs &slabs,
                                     std::vector<MergedPoint> merged) {
  if (!any_of_ranks(comm, !merged.empty()))
    return {};
  const TotalOrder less{slabs.axis};
  const std::vector<Ends> ends = ends_of_ranks(comm, slabs.sites.points);
  collectively(comm, [&] {
    std::sort(merged.begin(), merged.end(),
              [&](const MergedPoint &a, const MergedPoint &b) { return less(a.point, b.point); });
  });
  std::vector<std::int64_t> send_counts;
  auto begin = merged.begin();
  for (const Ends &rank : ends) {
    const auto end =
        rank.count == 0
            ? begin
            : std::upper_bound(begin, merged.end(), rank.last,
                               [&](Point last, const MergedPoint &m) { return less(last, m.point); });
    send_counts.push_back(end - begin);
    begin = end;
  }
  const Exchanged<MergedPoint> arrived = exchange<MergedPoint>(comm, merged, send_counts);
  const auto purpose = [&] { return fmt::format("{} duplicates", arrived.data.size()); };
  return collectively(comm, purpose, [&] {
    std::vector<Duplicate> duplicates;
    duplicates.reserve(arrived.data.size());
    const std::vector<Point> &sites = slabs.sites.points;
    auto site = sites.begin();
    for (const MergedPoint &point : arrived.data) {
      if (site == sites.end() || *site != point.point) // equal ones come one after another
        site = std::lower_bound(sites.begin(), sites.end(), point.point, less);
      duplicates.push_back({point.input_index, slabs.first_site() + (site - sites.begin()), point.z});
    }
    std::sort(duplicates.begin(), duplicates.end(), [](const Duplicate &a, const Duplicate &b) {
      return a.site < b.site || (a.site == b.site && a.input_index < b.input_index);
    });
    return duplicates;
  });
}

} // namespace

Slabs sort_into_slabs(const Communicator &comm, PointTable &&points, const SlabOptions &options) {
  if (options.slabs < 0)
    throw Error({ErrorKind::usage, "--slabs", "", fmt::format("{} is not a number of slabs", options.slabs),
                 "give a positive number, or 0 to have it chosen by size"});
  Slabs slabs;
  slabs.sites = std::move(points);
  PointTable &sites = slabs.sites;
  slabs.digest = digest_of(comm, sites);
  slabs.axis = options.axis == AxisChoice::x   ? Axis::x
               : options.axis == AxisChoice::y ? Axis::y
               : options.presorted             ? Axis::x
                                               : choose_axis(comm, sites.points);
  if (options.presorted)
    check_presorted(comm, sites, slabs.axis, options.subject);

  std::vector<MergedPoint> merged;
  const auto merge_equals = [&] { merge_equal_points(sites, options.duplicates, merged); };
  const auto purpose = [&] { return fmt::format("sorting {} points", sites.points.size()); };
  collectively(comm, purpose, [&] {
    sort_points(sites, slabs.axis, options.progress);
    merge_equals();
  });
  if (comm.size() > 1) {
    bring_together(comm, sites, slabs.axis, options);
    collectively(comm, purpose, merge_equals);
  }

  const auto site_count = all_reduce_sum(comm, static_cast<GlobalIndex>(sites.points.size()));
  Division division = division_of(comm, site_count, options.slabs);
  shift(comm, sites, slabs.axis, division.rank_begins);
  take_division(comm, std::move(division), options.subject, slabs);
  slabs.lines = lines_of(comm, slabs);
  slabs.duplicates = duplicates_of(comm, slabs, std::move(merged));
  if (options.duplicates == DuplicateRule::error)
    refuse_duplicates(comm, slabs, options.subject);
  return slabs;
}

} // namespace dovetail
