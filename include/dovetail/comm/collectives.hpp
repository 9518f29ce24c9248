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

#include <concepts>
#include <functional>
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

template <Number T> T all_reduce_min(const Communicator &comm, T value) {
  traffic::count_all_reduce(comm, sizeof(T));
  return boost::mpi::all_reduce(comm.boost(), value, boost::mpi::minimum<T>());
}

template <Number T> T all_reduce_max(const Communicator &comm, T value) {
  traffic::count_all_reduce(comm, sizeof(T));
  return boost::mpi::all_reduce(comm.boost(), value, boost::mpi::maximum<T>());
}

/// Elementwise, over vectors of the same length on every rank (also length 0). In `elementwise`, Operation is
/// std::plus<T>, boost::mpi::minimum<T> or boost::mpi::maximum<T>.
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
template <Number T> std::vector<T> all_reduce_min(const Communicator &comm, const std::vector<T> &values) {
  return all_reduce_elementwise(comm, values, boost::mpi::minimum<T>());
}
template <Number T> std::vector<T> all_reduce_max(const Communicator &comm, const std::vector<T> &values) {
  return all_reduce_elementwise(comm, values, boost::mpi::maximum<T>());
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

/// The root's value on every rank, for numbers and for every type with Boost.Serialization, such as a path
/// with its header. Up to 2 GiB serialised; longer data goes through broadcast_bulk.
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
