/// The one typed layer over MPI for bulk data: any trivially copyable type, 64-bit counts, and no single
/// message above comm.chunk_bytes() (but always at least one element), so that no count given to MPI comes
/// near 2^31. Elements travel as contiguous derived types of their own size. All are Collective, and all
/// count what they hand to MPI for other ranks, message by message.
///
/// What allocates for what arrives does so before it travels, and agrees on it (one all-reduce of an int):
/// where one rank lacks the memory, every rank throws the same Error of ErrorKind::resource. Arrays with a
/// few numbers for every rank, and what MPI allocates for itself, are too small to agree on and stay fatal.
#pragma once

#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/communicator.hpp"

#include <cstddef>
#include <exception>
#include <numeric>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace dovetail {

template <class T>
concept Bulk = std::is_trivially_copyable_v<T>;

/// What came from every rank, one rank after the other.
template <Bulk T> struct Exchanged {
  std::vector<T> data;
  std::vector<std::int64_t> counts; ///< elements from each rank
};

/// What goes to, or came from, one rank.
template <Bulk T> struct Outgoing {
  int rank;
  std::span<const T> data;
};
template <Bulk T> struct Incoming {
  int rank;
  std::vector<T> data;
};

/// The untyped core: bytes of elements of one size, counts in elements. Allocates nothing that grows with the
/// data, so that memory can be agreed on before it begins.
namespace bulk {

void exchange(const Communicator &comm, std::size_t element_bytes, const std::byte *send,
              std::span<const std::int64_t> send_counts, std::byte *receive,
              std::span<const std::int64_t> receive_counts);
void broadcast(const Communicator &comm, std::size_t element_bytes, std::byte *data, std::int64_t count,
               int root);
void gather(const Communicator &comm, std::size_t element_bytes, const std::byte *send, std::int64_t count,
            std::byte *receive, std::span<const std::int64_t> receive_counts, int root);

struct OutgoingBytes {
  int rank;
  const std::byte *data;
  std::int64_t count;
};
struct IncomingBytes {
  int rank;
  std::byte *data;
  std::int64_t count;
};

/// A sparse exchange in two steps: what comes is announced, and once there is room for it, it is delivered.
struct SparseRound {
  std::vector<OutgoingBytes> outgoing; ///< none of them empty
  std::vector<IncomingBytes> incoming; ///< by ascending rank; `data` is for the receiver to fill in
  std::vector<MPI_Request> requests;   ///< room for one for each of both
  std::exception_ptr failure;          ///< that kept this rank from sending or noting all
};
void announce(const Communicator &comm, SparseRound &round);
void deliver(const Communicator &comm, std::size_t element_bytes, SparseRound &round);

template <Bulk T> const std::byte *bytes(const T *data) { return reinterpret_cast<const std::byte *>(data); }
template <Bulk T> std::byte *bytes(T *data) { return reinterpret_cast<std::byte *>(data); }

/// "1.5 GiB that other ranks send": what a rank that cannot receive it lacks memory for.
std::string arriving_text(std::int64_t count, std::size_t element_bytes);

/// Collective: `data` gets room for `count` elements on every rank, or every rank throws the same Error.
template <Bulk T> void make_room(const Communicator &comm, std::vector<T> &data, std::int64_t count) {
  collectively(
      comm, [&] { return arriving_text(count, sizeof(T)); },
      [&] { data.resize(static_cast<std::size_t>(count)); });
}

} // namespace bulk

/// How many elements every rank will send to this one, given how many this one sends to every rank.
std::vector<std::int64_t> exchange_counts(const Communicator &comm,
                                          std::span<const std::int64_t> send_counts);

/// How many elements every rank has, on the root; empty elsewhere.
std::vector<std::int64_t> gather_counts(const Communicator &comm, std::int64_t count, int root);

/// All to all. `send` holds send_counts[0] elements for rank 0, then those for rank 1, and so on; `receive`
/// is filled likewise and must have exactly the sum of receive_counts elements. With the counts known,
/// columns go one after another through one pair of buffers.
template <Bulk T>
void exchange_into(const Communicator &comm, std::span<const T> send,
                   std::span<const std::int64_t> send_counts, std::span<T> receive,
                   std::span<const std::int64_t> receive_counts) {
  bulk::exchange(comm, sizeof(T), bulk::bytes(send.data()), send_counts, bulk::bytes(receive.data()),
                 receive_counts);
}

/// All to all, with counts and buffer made for the caller.
template <Bulk T>
Exchanged<T> exchange(const Communicator &comm, std::span<const T> send,
                      std::span<const std::int64_t> send_counts) {
  Exchanged<T> result;
  result.counts = exchange_counts(comm, send_counts);
  bulk::make_room(comm, result.data,
                  std::accumulate(result.counts.begin(), result.counts.end(), std::int64_t{0}));
  exchange_into<T>(comm, send, send_counts, result.data, result.counts);
  return result;
}

/// All to few: every rank names the ranks it has something for, each at most once (itself is allowed), and
/// gets what came by ascending rank. An empty message is not delivered.
///
/// First every rank learns what it will get, by the non-blocking consensus of Hoefler, Siebert and Lumsdaine
/// (2010): synchronous sends of the counts, and a non-blocking barrier once they are received. No rank has
/// any array of the size of the communicator, so the cost is that of the messages plus O(log ranks); an
/// all-to-all of counts would cost every one of P ranks P counts. The data follow once every rank has room
/// for them.
template <Bulk T>
std::vector<Incoming<T>> sparse_exchange(const Communicator &comm, std::span<const Outgoing<T>> outgoing) {
  bulk::SparseRound round;
  try {
    round.outgoing.reserve(outgoing.size());
    for (const Outgoing<T> &letter : outgoing)
      if (!letter.data.empty())
        round.outgoing.push_back(
            {letter.rank, bulk::bytes(letter.data.data()), static_cast<std::int64_t>(letter.data.size())});
  } catch (...) { // the others expect this rank to take part
    round.outgoing.clear();
    round.failure = std::current_exception();
  }
  bulk::announce(comm, round);
  std::vector<Incoming<T>> result;
  const auto arriving = [&] {
    std::int64_t count = 0;
    for (const bulk::IncomingBytes &letter : round.incoming)
      count += letter.count;
    return bulk::arriving_text(count, sizeof(T));
  };
  collectively(comm, arriving, [&] {
    if (round.failure)
      std::rethrow_exception(round.failure);
    round.requests.resize(round.outgoing.size() + round.incoming.size());
    result.reserve(round.incoming.size());
    for (bulk::IncomingBytes &letter : round.incoming) {
      result.push_back({letter.rank, std::vector<T>(static_cast<std::size_t>(letter.count))});
      letter.data = bulk::bytes(result.back().data.data());
    }
  });
  bulk::deliver(comm, sizeof(T), round);
  return result;
}

/// The root's vector, of any length, on every rank.
template <Bulk T> void broadcast_bulk(const Communicator &comm, std::vector<T> &data, int root = 0) {
  std::int64_t count = static_cast<std::int64_t>(data.size());
  bulk::broadcast(comm, sizeof count, bulk::bytes(&count), 1, root);
  bulk::make_room(comm, data, count);
  bulk::broadcast(comm, sizeof(T), bulk::bytes(data.data()), count, root);
}

/// Every rank's elements on the root, one rank after the other; empty elsewhere (counts as well).
template <Bulk T> Exchanged<T> gather_bulk(const Communicator &comm, std::span<const T> data, int root = 0) {
  const auto count = static_cast<std::int64_t>(data.size());
  Exchanged<T> result;
  result.counts = gather_counts(comm, count, root);
  bulk::make_room(comm, result.data,
                  std::accumulate(result.counts.begin(), result.counts.end(), std::int64_t{0}));
  bulk::gather(comm, sizeof(T), bulk::bytes(data.data()), count, bulk::bytes(result.data.data()),
               result.counts, root);
  return result;
}

/// Every rank's elements on every rank.
template <Bulk T> Exchanged<T> all_gather_bulk(const Communicator &comm, std::span<const T> data) {
  const auto count = static_cast<std::int64_t>(data.size());
  Exchanged<T> result;
  result.counts = all_gather(comm, count);
  const std::int64_t total = std::accumulate(result.counts.begin(), result.counts.end(), std::int64_t{0});
  bulk::make_room(comm, result.data, total);
  bulk::gather(comm, sizeof(T), bulk::bytes(data.data()), count, bulk::bytes(result.data.data()),
               result.counts, 0);
  bulk::broadcast(comm, sizeof(T), bulk::bytes(result.data.data()), total, 0);
  return result;
}

} // namespace dovetail
