/// Collectives on single values, short vectors and serialisable structs. All are Collective.
/// Bulk data goes through exchange.hpp.
///
/// What they count as traffic is a model, since MPI does not tell: reductions, scans and all-gathers are
/// ceil(log2 ranks) messages a rank (recursive doubling; an all-gather sends its ranks - 1 values in them), a
/// broadcast is a binomial tree, and in a gather every rank but the root sends one message to the root.
#pragma once

#include "dovetail/comm/communicator.hpp"

#include <boost/mpi/collectives/all_gather.hpp>
#include <boost/mpi/collectives/all_reduce.hpp>
#include <boost/mpi/collectives/broadcast.hpp>
#include <boost/mpi/collectives/gather.hpp>
#include <boost/mpi/collectives/scan.hpp>
#include <boost/mpi/operations.hpp>
#include <boost/mpi/packed_oarchive.hpp>

#include <algorithm>
#include <concepts>
#include <functional>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

namespace dovetail {

/// A number that MPI knows by itself.
template <class T>
concept Number = std::integral<T> || std::floating_point<T>;

namespace traffic {
/// Add to comm.traffic() what the model above says for `bytes` of payload.
void count_all_reduce(const Communicator &comm, std::int64_t bytes);
void count_all_gather(const Communicator &comm, std::int64_t bytes);
void count_broadcast(const Communicator &comm, std::int64_t bytes, int root);
void count_gather(const Communicator &comm, std::int64_t bytes, int root);

/// Size of a value in Boost.MPI's packed archive. Costs as much as packing it, so it is for short things.
template <class T> std::int64_t packed_bytes(const Communicator &comm, const T &value) {
  if constexpr (boost::mpi::is_mpi_datatype<T>::value) {
    return static_cast<std::int64_t>(sizeof(T));
  } else {
    boost::mpi::packed_oarchive archive(comm.raw());
    archive << value;
    return static_cast<std::int64_t>(archive.size());
  }
}
} // namespace traffic

template <Number T> T all_reduce_sum(const Communicator &comm, T value) {
  traffic::count_all_reduce(comm, sizeof(T));
  return boost::mpi::all_reduce(comm.boost(), value, std::plus<T>());
}

/// Elementwise, over vectors of the same length on every rank (also length 0).
template <Number T, class Operation>
std::vector<T> all_reduce_elementwise(const Communicator &comm, const std::vector<T> &values, Operation op) {
  std::vector<T> result(values.size());
  if (values.empty())
    return result;
  traffic::count_all_reduce(comm, static_cast<std::int64_t>(sizeof(T) * values.size()));
  boost::mpi::all_reduce(comm.boost(), values.data(), static_cast<int>(values.size()), result.data(), op);
  return result;
}

template <Number T> std::vector<T> all_reduce_sum(const Communicator &comm, const std::vector<T> &values) {
  return all_reduce_elementwise(comm, values, std::plus<T>());
}

/// Open MPI 4.1 compares 64-bit unsigned numbers as if they were signed (measured: of 3 and 2^64 - 1 the
/// latter is the MPI_MIN). So unsigned numbers are moved to signed ones in the same order, and back.
namespace ordered {
template <Number T> auto to_signed(T value) {
  if constexpr (std::unsigned_integral<T> && !std::same_as<T, bool>) {
    using Signed = std::make_signed_t<T>;
    return static_cast<Signed>(static_cast<T>(value ^ static_cast<T>(std::numeric_limits<Signed>::min())));
  } else {
    return value;
  }
}
template <Number T, Number Moved> T from_signed(Moved value) {
  if constexpr (std::same_as<T, Moved>)
    return value;
  else
    return static_cast<T>(static_cast<T>(value) ^ static_cast<T>(std::numeric_limits<Moved>::min()));
}
} // namespace ordered

template <Number T, template <class> class Operation>
std::vector<T> all_reduce_ordered(const Communicator &comm, const std::vector<T> &values) {
  using Moved = decltype(ordered::to_signed(T{}));
  std::vector<Moved> moved(values.size());
  std::transform(values.begin(), values.end(), moved.begin(), ordered::to_signed<T>);
  moved = all_reduce_elementwise(comm, moved, Operation<Moved>());
  std::vector<T> result(values.size());
  std::transform(moved.begin(), moved.end(), result.begin(), ordered::from_signed<T, Moved>);
  return result;
}

template <Number T> std::vector<T> all_reduce_min(const Communicator &comm, const std::vector<T> &values) {
  return all_reduce_ordered<T, boost::mpi::minimum>(comm, values);
}
template <Number T> std::vector<T> all_reduce_max(const Communicator &comm, const std::vector<T> &values) {
  return all_reduce_ordered<T, boost::mpi::maximum>(comm, values);
}
template <Number T, template <class> class Operation>
T all_reduce_ordered(const Communicator &comm, T value) {
  using Moved = decltype(ordered::to_signed(T{}));
  traffic::count_all_reduce(comm, sizeof(T));
  return ordered::from_signed<T>(
      boost::mpi::all_reduce(comm.boost(), ordered::to_signed(value), Operation<Moved>()));
}
template <Number T> T all_reduce_min(const Communicator &comm, T value) {
  return all_reduce_ordered<T, boost::mpi::minimum>(comm, value);
}
template <Number T> T all_reduce_max(const Communicator &comm, T value) {
  return all_reduce_ordered<T, boost::mpi::maximum>(comm, value);
}

inline bool any_of_ranks(const Communicator &comm, bool value) {
  return all_reduce_max(comm, static_cast<int>(value)) != 0;
}
inline bool all_of_ranks(const Communicator &comm, bool value) {
  return all_reduce_min(comm, static_cast<int>(value)) != 0;
}

/// Sum of the values of all lower ranks; zero on the first.
template <std::integral T> T exclusive_scan(const Communicator &comm, T value) {
  traffic::count_all_reduce(comm, sizeof(T));
  // Boost.MPI has the inclusive scan only; for integers the difference is exact.
  return static_cast<T>(boost::mpi::scan(comm.boost(), value, std::plus<T>()) - value);
}

/// The same for every element of vectors of the same length on every rank (also length 0).
template <std::integral T>
std::vector<T> exclusive_scan(const Communicator &comm, const std::vector<T> &values) {
  std::vector<T> sums(values.size());
  if (values.empty())
    return sums;
  traffic::count_all_reduce(comm, static_cast<std::int64_t>(sizeof(T) * values.size()));
  boost::mpi::scan(comm.boost(), values.data(), static_cast<int>(values.size()), sums.data(), std::plus<T>());
  for (std::size_t i = 0; i < sums.size(); ++i)
    sums[i] = static_cast<T>(sums[i] - values[i]);
  return sums;
}

/// One value from every rank, by rank, on every rank.
template <class T>
  requires std::is_trivially_copyable_v<T>
std::vector<T> all_gather(const Communicator &comm, const T &value) {
  traffic::count_all_gather(comm, sizeof(T));
  std::vector<T> values(static_cast<std::size_t>(comm.size()));
  MPI_Allgather(&value, static_cast<int>(sizeof(T)), MPI_BYTE, values.data(), static_cast<int>(sizeof(T)),
                MPI_BYTE, comm.raw());
  return values;
}

/// The root's value on every rank, for numbers and for every type with Boost.Serialization, such as a path.
/// Up to 2 GiB serialised; longer data goes through broadcast_bulk.
template <class T> void broadcast(const Communicator &comm, T &value, int root = 0) {
  boost::mpi::broadcast(comm.boost(), value, root);
  traffic::count_broadcast(comm, traffic::packed_bytes(comm, value), root);
}

/// Every rank's value, by rank, on the root; empty elsewhere. For numbers and every type with
/// Boost.Serialization. Up to 2 GiB serialised in all; longer data goes through gather_bulk.
template <class T> std::vector<T> gather(const Communicator &comm, const T &value, int root = 0) {
  traffic::count_gather(comm, comm.rank() == root ? 0 : traffic::packed_bytes(comm, value), root);
  std::vector<T> values;
  if (comm.rank() == root)
    boost::mpi::gather(comm.boost(), value, values, root);
  else
    boost::mpi::gather(comm.boost(), value, root);
  return values;
}

} // namespace dovetail
