/// Boost.Serialization for what travels between ranks. Plain structs without padding also become MPI
/// datatypes, which makes vectors of them one block in an archive instead of one call an element.
#pragma once

#include "dovetail/base/error.hpp"
#include "dovetail/base/point_table.hpp"
#include "dovetail/base/types.hpp"

#include <boost/mpi/datatype.hpp>
#include <boost/serialization/is_bitwise_serializable.hpp>
#include <boost/serialization/level.hpp>
#include <boost/serialization/string.hpp>
#include <boost/serialization/tracking.hpp>
#include <boost/serialization/vector.hpp>

/// For structs at global scope, after their `serialize`: no class versions, no address tracking, one block.
#define DOVETAIL_PLAIN_STRUCT(Type)                                                                          \
  BOOST_IS_MPI_DATATYPE(Type)                                                                                \
  BOOST_IS_BITWISE_SERIALIZABLE(Type)                                                                        \
  BOOST_CLASS_IMPLEMENTATION(Type, object_serializable)                                                      \
  BOOST_CLASS_TRACKING(Type, track_never)

namespace boost::serialization {

template <class Archive> void serialize(Archive &archive, dovetail::Point &point, unsigned) {
  archive &point.x &point.y;
}

template <class Archive> void serialize(Archive &archive, dovetail::Problem &problem, unsigned) {
  archive &problem.kind &problem.subject &problem.place &problem.what &problem.remedy;
}

template <class Archive>
void serialize(Archive &archive, dovetail::CoordinateSystemRecord &record, unsigned) {
  archive &record.user_id &record.record_id &record.description &record.bytes;
}

} // namespace boost::serialization

DOVETAIL_PLAIN_STRUCT(dovetail::Point)
