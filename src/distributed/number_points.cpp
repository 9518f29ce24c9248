#include "dovetail/distributed/number_points.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/serialization.hpp"

#include <cmath>
#include <fmt/format.h>
#include <numeric>
#include <vector>

namespace dovetail {
namespace {

std::vector<std::string> attribute_names(const PointTable &table) {
  std::vector<std::string> names;
  names.reserve(table.attributes.size());
  for (const Attribute &attribute : table.attributes)
    names.push_back(attribute.name);
  return names;
}

void check_columns(const PointTable &table, const std::vector<std::string> &names, const std::string &subject,
                   const std::string &place) {
  if (attribute_names(table) != names)
    throw Error({ErrorKind::usage, subject, place, "the attributes differ from those of rank 0",
                 "give every rank the same attributes in the same order, also where it has no points"});
  const auto check = [&](const std::string &column, std::size_t length) {
    if (length != table.points.size())
      throw Error(
          {ErrorKind::usage, subject, place,
           fmt::format("there are {} points and {} values of {}", table.points.size(), length, column),
           "give one value for each point"});
  };
  check("input_index", table.input_index.size());
  for (const Attribute &attribute : table.attributes)
    check(attribute.name, attribute.values.size());
}

/// How errors name the point at `position`.
std::string place_of(const PointTable &table, std::size_t position, const std::string &rank) {
  return fmt::format("{}, point {} (input index {})", rank, position, table.input_index[position]);
}

void check_values(PointTable &table, const std::string &subject, const std::string &rank) {
  for (std::size_t i = 0; i < table.points.size(); ++i) {
    Point &point = table.points[i];
    if (!std::isfinite(point.x) || !std::isfinite(point.y))
      throw Error({ErrorKind::input, subject, place_of(table, i, rank),
                   fmt::format("({}, {}) is not a position in the plane", point.x, point.y),
                   "leave the point out or repair it"});
    point = {point.x + 0.0, point.y + 0.0}; // makes -0.0 to 0.0
  }
  if (table.attributes.empty() || table.attributes.front().name != "z")
    return;
  const std::vector<double> &z = table.attributes.front().values;
  for (std::size_t i = 0; i < z.size(); ++i)
    if (!std::isfinite(z[i]))
      throw Error({ErrorKind::input, subject, place_of(table, i, rank), fmt::format("z is {}", z[i]),
                   "leave the point out or give it a height"});
}

} // namespace

PointTable number_points(const Communicator &comm, std::span<const Point> points) {
  const GlobalIndex first = exclusive_scan(comm, static_cast<GlobalIndex>(points.size()));
  return collectively(comm, [&] {
    PointTable table;
    table.points.assign(points.begin(), points.end());
    table.input_index.resize(points.size());
    std::iota(table.input_index.begin(), table.input_index.end(), first);
    return table;
  });
}

void check_points(const Communicator &comm, PointTable &table, const std::string &subject) {
  std::vector<std::string> names = attribute_names(table);
  broadcast(comm, names);
  collectively(comm, [&] {
    const std::string rank = "rank " + std::to_string(comm.rank());
    check_columns(table, names, subject, rank);
    check_values(table, subject, rank);
  });
}

} // namespace dovetail
