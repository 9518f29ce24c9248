#include "cut_slabs.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/exchange.hpp"
#include "dovetail/distributed/scratch_sites.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace dovetail {
namespace {

std::size_t index(std::int64_t value) { return static_cast<std::size_t>(value); }

/// All ranks know the same sizes, so all of them throw or none.
void check_sizes(const Slabs &slabs, const std::string &subject) {
  constexpr GlobalIndex most = (GlobalIndex{1} << 31) / 6;
  const GlobalIndex largest = (slabs.site_count() + slabs.slab_count() - 1) / slabs.slab_count();
  if (largest > most)
    throw Error({ErrorKind::resource, subject, "",
                 fmt::format("{} sites in {} slabs are more than the {} that a slab can have",
                             slabs.site_count(), slabs.slab_count(), most),
                 fmt::format("cut more: --slabs {} or above", (slabs.site_count() + most - 1) / most)});
}

} // namespace

int default_slab_count(GlobalIndex sites, int ranks) {
  constexpr GlobalIndex sites_of_a_slab = 1'500'000;
  constexpr GlobalIndex sites_worth_a_rank = 1'000;
  if (sites < sites_worth_a_rank * ranks)
    return static_cast<int>(std::max<GlobalIndex>(1, sites / sites_worth_a_rank));
  const auto most = static_cast<GlobalIndex>(std::sqrt(static_cast<double>(sites)) / 26);
  const GlobalIndex wanted = (sites + sites_of_a_slab * ranks - 1) / (sites_of_a_slab * ranks);
  const GlobalIndex each = std::max<GlobalIndex>(1, std::min(wanted, most / ranks));
  return static_cast<int>(std::min<GlobalIndex>(each * ranks, std::numeric_limits<int>::max()));
}

std::vector<GlobalIndex> slab_offsets(GlobalIndex sites, int slabs) {
  const GlobalIndex share = sites / slabs;
  const GlobalIndex rest = sites % slabs;
  std::vector<GlobalIndex> offsets;
  offsets.reserve(static_cast<std::size_t>(slabs) + 1);
  for (GlobalIndex s = 0; s <= slabs; ++s)
    offsets.push_back(share * s + rest * s / slabs); // floor(sites * s / slabs), and cannot overflow
  return offsets;
}

Division division_of(const Communicator &comm, GlobalIndex sites, int slabs) {
  const int ranks = comm.size();
  if (slabs == 0)
    slabs = default_slab_count(sites, ranks);
  return collectively(
      comm, [&] { return fmt::format("the table of {} slabs", slabs); },
      [&] {
        Division division{slab_offsets(sites, slabs), {}};
        for (int rank = 0; rank <= ranks; ++rank)
          division.rank_begins.push_back(division.slab_begins[index(first_slab_of_rank(slabs, rank, ranks))]);
        return division;
      });
}

void take_division(const Communicator &comm, Division &&division, const std::string &subject, Slabs &slabs) {
  slabs.site_offsets = std::move(division.slab_begins);
  check_sizes(slabs, subject);
  slabs.first_slab = first_slab_of_rank(slabs.slab_count(), comm.rank(), comm.size());
  slabs.own_slab_count =
      first_slab_of_rank(slabs.slab_count(), comm.rank() + 1, comm.size()) - slabs.first_slab;
}

PointTable table_of_sites(const Slabs &slabs, GlobalIndex first, GlobalIndex count) {
  PointTable table;
  if (slabs.scratch) {
    table.attributes = slabs.sites.attributes;
    slabs.scratch->read(first, count, table);
    return table;
  }
  const auto begin = first - slabs.first_site();
  const auto rows = [&](const auto &column) {
    return std::remove_cvref_t<decltype(column)>(column.begin() + begin, column.begin() + begin + count);
  };
  table.points = rows(slabs.sites.points);
  table.input_index = rows(slabs.sites.input_index);
  for (const Attribute &attribute : slabs.sites.attributes)
    table.attributes.push_back({attribute.name, rows(attribute.values)});
  return table;
}

/// Every line is the `across` of one site, whose rank knows it.
std::vector<double> lines_of(const Communicator &comm, const Slabs &slabs) {
  if (slabs.site_count() == 0)
    return collectively(
        comm, [] { return "the lines between slabs"; },
        [&] { return std::vector<double>(index(slabs.slab_count() - 1), 0.0); });
  const GlobalIndex begin = slabs.first_site();
  const GlobalIndex end = slabs.site_offsets[index(slabs.first_slab + slabs.own_slab_count)];
  const auto own = collectively(
      comm, [] { return "the lines between slabs"; },
      [&] {
        std::vector<double> lines;
        for (int s = 1; s < slabs.slab_count(); ++s) {
          const GlobalIndex site = std::max<GlobalIndex>(slabs.site_offsets[index(s)], 1) - 1;
          if (site >= begin && site < end)
            lines.push_back(across(table_of_sites(slabs, site, 1).points.front(), slabs.axis));
        }
        return lines;
      });
  return all_gather_bulk<double>(comm, own).data;
}

void refuse_duplicates(const Communicator &comm, const Slabs &slabs, const std::string &subject) {
  std::optional<Problem> problem;
  std::vector<Duplicate> duplicates;
  for (int k = 0; k < slabs.own_slab_count && duplicates.empty(); ++k)
    duplicates = duplicates_of_slab(slabs, k);
  if (!duplicates.empty()) {
    const Duplicate &duplicate = duplicates.front();
    const PointTable site = table_of_sites(slabs, duplicate.site, 1);
    const Point point = site.points.front();
    problem = Problem{
        ErrorKind::input, subject, fmt::format("point {}", duplicate.input_index),
        fmt::format("equals point {}: both are at ({}, {})", site.input_index.front(), point.x, point.y),
        "say which one represents both: --duplicates first, lowest or highest"};
  }
  agree(comm, problem);
}

} // namespace dovetail
