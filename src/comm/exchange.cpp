#include "dovetail/comm/exchange.hpp"

#include "dovetail/comm/collectives.hpp"

#include <boost/mpi/collectives/all_to_all.hpp>

#include <cassert>
#include <cstring>
#include <limits>

namespace dovetail {
namespace bulk {
namespace {

enum Tag : int { exchange_tag = 1, gather_tag, sparse_data_tag, sparse_count_tag, sparse_count_tag_odd };

/// So many partners have messages under way at a time: enough to hide latency, few enough for thousands of
/// ranks not to hold thousands of requests each.
constexpr int partners_at_a_time = 32;

/// A contiguous MPI datatype of one element's size, so that counts count elements.
class ElementType {
public:
  explicit ElementType(std::size_t bytes) {
    assert(bytes <= static_cast<std::size_t>(std::numeric_limits<int>::max()));
    MPI_Type_contiguous(static_cast<int>(bytes), MPI_BYTE, &type_);
    MPI_Type_commit(&type_);
  }
  ~ElementType() { MPI_Type_free(&type_); }
  ElementType(const ElementType &) = delete;
  ElementType &operator=(const ElementType &) = delete;
  operator MPI_Datatype() const { return type_; }

private:
  MPI_Datatype type_ = MPI_DATATYPE_NULL;
};

/// Calls piece(first element, elements) for each message that `count` elements are cut into.
template <class Piece>
void for_each_chunk(const Communicator &comm, std::size_t element_bytes, std::int64_t count, Piece &&piece) {
  const std::int64_t limit = std::clamp<std::int64_t>(
      comm.chunk_bytes() / static_cast<std::int64_t>(element_bytes), 1, std::numeric_limits<int>::max());
  for (std::int64_t first = 0; first < count; first += limit)
    piece(first, static_cast<int>(std::min(limit, count - first)));
}

std::int64_t offset_bytes(std::int64_t elements, std::size_t element_bytes) {
  return elements * static_cast<std::int64_t>(element_bytes);
}

/// Point-to-point messages of one element type under way, cut into chunks. Chunks of one pair of ranks carry
/// the same tag: MPI keeps their order.
class Messages {
public:
  Messages(const Communicator &comm, std::size_t element_bytes)
      : comm_(comm), element_bytes_(element_bytes), type_(element_bytes) {}

  void send(const std::byte *data, std::int64_t count, int to, int tag) {
    for_each_chunk(comm_, element_bytes_, count, [&](std::int64_t first, int length) {
      MPI_Isend(data + offset_bytes(first, element_bytes_), length, type_, to, tag, comm_.raw(),
                &requests_.emplace_back());
      comm_.traffic().messages_sent += 1;
      comm_.traffic().bytes_sent += offset_bytes(length, element_bytes_);
    });
  }
  void receive(std::byte *data, std::int64_t count, int from, int tag) {
    for_each_chunk(comm_, element_bytes_, count, [&](std::int64_t first, int length) {
      MPI_Irecv(data + offset_bytes(first, element_bytes_), length, type_, from, tag, comm_.raw(),
                &requests_.emplace_back());
    });
  }
  void wait() {
    MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE);
    requests_.clear();
  }

private:
  const Communicator &comm_;
  std::size_t element_bytes_;
  ElementType type_;
  std::vector<MPI_Request> requests_;
};

std::vector<std::int64_t> offsets_of(std::span<const std::int64_t> counts) {
  std::vector<std::int64_t> offsets(counts.size() + 1, 0);
  std::partial_sum(counts.begin(), counts.end(), offsets.begin() + 1);
  return offsets;
}

void copy_own(std::byte *to, const std::byte *from, std::int64_t bytes) {
  if (bytes > 0)
    std::memcpy(to, from, static_cast<std::size_t>(bytes));
}

} // namespace

void exchange(const Communicator &comm, std::size_t element_bytes, const std::byte *send,
              std::span<const std::int64_t> send_counts, std::byte *receive,
              std::span<const std::int64_t> receive_counts) {
  const int ranks = comm.size();
  const int rank = comm.rank();
  assert(std::ssize(send_counts) == ranks && std::ssize(receive_counts) == ranks);
  const auto send_offsets = offsets_of(send_counts);
  const auto receive_offsets = offsets_of(receive_counts);
  const auto own = static_cast<std::size_t>(rank);
  assert(send_counts[own] == receive_counts[own]);
  copy_own(receive + offset_bytes(receive_offsets[own], element_bytes),
           send + offset_bytes(send_offsets[own], element_bytes),
           offset_bytes(send_counts[own], element_bytes));

  // At every step each rank sends to one rank and receives from one other, so nobody is a hot spot.
  Messages messages(comm, element_bytes);
  for (int step = 1; step < ranks; step += partners_at_a_time) {
    const int end = std::min(ranks, step + partners_at_a_time);
    for (int s = step; s < end; ++s) {
      const auto from = static_cast<std::size_t>((rank - s + ranks) % ranks);
      messages.receive(receive + offset_bytes(receive_offsets[from], element_bytes), receive_counts[from],
                       static_cast<int>(from), exchange_tag);
    }
    for (int s = step; s < end; ++s) {
      const auto to = static_cast<std::size_t>((rank + s) % ranks);
      messages.send(send + offset_bytes(send_offsets[to], element_bytes), send_counts[to],
                    static_cast<int>(to), exchange_tag);
    }
    messages.wait();
  }
}

void broadcast(const Communicator &comm, std::size_t element_bytes, std::byte *data, std::int64_t count,
               int root) {
  const ElementType type(element_bytes);
  for_each_chunk(comm, element_bytes, count, [&](std::int64_t first, int length) {
    MPI_Bcast(data + offset_bytes(first, element_bytes), length, type, root, comm.raw());
    traffic::count_broadcast(comm, offset_bytes(length, element_bytes), root);
  });
}

void gather(const Communicator &comm, std::size_t element_bytes, const std::byte *send, std::int64_t count,
            std::byte *receive, std::span<const std::int64_t> receive_counts, int root) {
  Messages messages(comm, element_bytes);
  if (comm.rank() != root) {
    messages.send(send, count, root, gather_tag);
    messages.wait();
    return;
  }
  const auto offsets = offsets_of(receive_counts);
  for (int from = 0; from < comm.size(); ++from) {
    const auto f = static_cast<std::size_t>(from);
    std::byte *place = receive + offset_bytes(offsets[f], element_bytes);
    if (from == root)
      copy_own(place, send, offset_bytes(count, element_bytes));
    else
      messages.receive(place, receive_counts[f], from, gather_tag);
    if (from % partners_at_a_time == partners_at_a_time - 1)
      messages.wait();
  }
  messages.wait();
}

std::vector<IncomingBytes> sparse_exchange(const Communicator &comm, std::size_t element_bytes,
                                           std::span<const OutgoingBytes> outgoing) {
  // A rank that has left this exchange may already announce something in the next one while another still
  // listens to this one. It cannot be two ahead, so two alternating tags tell them apart.
  const int count_tag = comm.next_sparse_round() % 2 == 0 ? sparse_count_tag : sparse_count_tag_odd;
  std::vector<IncomingBytes> incoming;
  std::vector<MPI_Request> announcements;
  announcements.reserve(outgoing.size());
  Messages messages(comm, element_bytes);
  const auto make_room = [&](int from, std::int64_t count) -> std::byte * {
    incoming.push_back(
        {from, std::vector<std::byte>(static_cast<std::size_t>(offset_bytes(count, element_bytes)))});
    return incoming.back().data.data();
  };
  for (const OutgoingBytes &letter : outgoing) {
    if (letter.count == 0)
      continue;
    if (letter.rank == comm.rank()) {
      copy_own(make_room(letter.rank, letter.count), letter.data, offset_bytes(letter.count, element_bytes));
      continue;
    }
    MPI_Issend(&letter.count, 1, MPI_INT64_T, letter.rank, count_tag, comm.raw(),
               &announcements.emplace_back());
    comm.traffic().messages_sent += 1;
    comm.traffic().bytes_sent += static_cast<std::int64_t>(sizeof letter.count);
    messages.send(letter.data, letter.count, letter.rank, sparse_data_tag);
  }

  MPI_Request barrier = MPI_REQUEST_NULL;
  for (bool all_heard = false; !all_heard;) {
    int announced = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, count_tag, comm.raw(), &announced, &status);
    if (announced != 0) {
      std::int64_t count = 0;
      MPI_Recv(&count, 1, MPI_INT64_T, status.MPI_SOURCE, count_tag, comm.raw(), MPI_STATUS_IGNORE);
      messages.receive(make_room(status.MPI_SOURCE, count), count, status.MPI_SOURCE, sparse_data_tag);
    }
    int done = 0;
    if (barrier == MPI_REQUEST_NULL) {
      MPI_Testall(static_cast<int>(announcements.size()), announcements.data(), &done, MPI_STATUSES_IGNORE);
      if (done != 0) {
        MPI_Ibarrier(comm.raw(), &barrier);
        traffic::count_all_reduce(comm, 0);
      }
    } else {
      MPI_Test(&barrier, &done, MPI_STATUS_IGNORE);
      all_heard = done != 0;
    }
  }
  messages.wait();
  std::sort(incoming.begin(), incoming.end(),
            [](const IncomingBytes &a, const IncomingBytes &b) { return a.rank < b.rank; });
  return incoming;
}

} // namespace bulk

std::vector<std::int64_t> exchange_counts(const Communicator &comm,
                                          std::span<const std::int64_t> send_counts) {
  assert(std::ssize(send_counts) == comm.size());
  std::vector<std::int64_t> receive_counts(send_counts.size());
  boost::mpi::all_to_all(comm.boost(), send_counts.data(), 1, receive_counts.data());
  comm.traffic().messages_sent += comm.size() - 1;
  comm.traffic().bytes_sent += (comm.size() - 1) * static_cast<std::int64_t>(sizeof(std::int64_t));
  return receive_counts;
}

std::vector<std::int64_t> gather_counts(const Communicator &comm, std::int64_t count, int root) {
  return gather(comm, count, root);
}

} // namespace dovetail
