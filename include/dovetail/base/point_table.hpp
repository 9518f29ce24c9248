/// Points with what came with them: the form in which a rank holds its share of an input.
#pragma once

#include "dovetail/base/types.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace dovetail {

/// A column of numbers carried along with the points, such as z.
struct Attribute {
  std::string name;
  std::vector<double> values; ///< one for each point of the table
};

/// Structure of arrays: `points`, `input_index` and every attribute have the same length.
/// Every rank has the same attributes in the same order, also a rank without points.
struct PointTable {
  std::vector<Point> points;
  std::vector<GlobalIndex> input_index; ///< position in the concatenated inputs, counted from 0
  std::vector<Attribute> attributes;    ///< "z", if there is one, comes first
};

/// A record that says in which coordinate system an input is, carried through unread (LAS variable length
/// records).
struct CoordinateSystemRecord {
  std::string user_id;
  std::uint16_t record_id = 0;
  std::string description;
  std::vector<std::uint8_t> bytes;
  friend bool operator==(const CoordinateSystemRecord &, const CoordinateSystemRecord &) = default;
};

/// A point that equals a site and is not its representative.
struct Duplicate {
  GlobalIndex input_index; ///< of the point that was merged away
  GlobalIndex site;        ///< global number of the site it equals
  double z = 0;            ///< its own z, which the site need not share; 0 without a "z" attribute
  friend constexpr bool operator==(const Duplicate &, const Duplicate &) = default;
};

} // namespace dovetail
