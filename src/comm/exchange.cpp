#include "dovetail/comm/exchange.hpp"

#include "dovetail/comm/collectives.hpp"

#include <boost/mpi/collectives/all_to_all.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <limits>

namespace dovetail {
namespace bulk {
namespace {

enum Tag : int { exchange_tag = 1, gather_tag, sparse_data_tag, sparse_count_tag, sparse_count_tag_odd };

/// So many partners have messages under way at a time: enough to hide latency, few enough for thousands of
/// ranks not to hold thousands of requests each.
constexpr std::size_t partners_at_a_time = 32;

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

std::int64_t elements_of_a_chunk(const Communicator &comm, std::size_t element_bytes) {
  return std::clamp<std::int64_t>(comm.chunk_bytes() / static_cast<std::int64_t>(element_bytes), 1,
                                  std::numeric_limits<int>::max());
}

std::int64_t offset_bytes(std::int64_t elements, std::size_t element_bytes) {
  return elements * static_cast<std::int64_t>(element_bytes);
}

/// Messages of one element type among any ranks, cut into chunks. The first chunks of all are under way
/// together, then the second ones, and so on: so `requests` needs room for one of each message only, and
/// since all ranks count the rounds alike, nobody waits for a chunk that another sends after waiting itself.
/// Chunks of one pair of ranks carry the same tag: MPI keeps their order.
void transfer(const Communicator &comm, std::size_t element_bytes, int tag,
              std::span<const IncomingBytes> incoming, std::span<const OutgoingBytes> outgoing,
              std::span<MPI_Request> requests) {
  assert(requests.size() >= incoming.size() + outgoing.size());
  const ElementType type(element_bytes);
  const std::int64_t limit = elements_of_a_chunk(comm, element_bytes);
  for (std::int64_t first = 0, left = 1; left > 0; first += limit) {
    int under_way = 0;
    left = 0;
    const auto length_from_first = [&](std::int64_t count) {
      left = std::max(left, count - first - limit);
      return static_cast<int>(std::min(limit, count - first));
    };
    const auto request = [&] { return &requests[static_cast<std::size_t>(under_way++)]; };
    for (const IncomingBytes &letter : incoming)
      if (letter.count > first)
        MPI_Irecv(letter.data + offset_bytes(first, element_bytes), length_from_first(letter.count), type,
                  letter.rank, tag, comm.raw(), request());
    for (const OutgoingBytes &letter : outgoing)
      if (letter.count > first) {
        const int length = length_from_first(letter.count);
        MPI_Isend(letter.data + offset_bytes(first, element_bytes), length, type, letter.rank, tag,
                  comm.raw(), request());
        comm.traffic().messages_sent += 1;
        comm.traffic().bytes_sent += offset_bytes(length, element_bytes);
      }
    MPI_Waitall(under_way, requests.data(), MPI_STATUSES_IGNORE);
  }
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
  assert(std::ssize(send_counts) == ranks && std::ssize(receive_counts) == ranks);
  const auto own = static_cast<std::size_t>(comm.rank());
  assert(send_counts[own] == receive_counts[own]);
  const auto bytes_of = [&](std::span<const std::int64_t> counts) {
    return offset_bytes(std::reduce(counts.begin(), counts.end()), element_bytes);
  };
  const std::byte *const own_data = send + bytes_of(send_counts.first(own));
  std::byte *const own_place = receive + bytes_of(receive_counts.first(own));
  copy_own(own_place, own_data, offset_bytes(send_counts[own], element_bytes));

  // At every step each rank sends to one rank, upwards from itself, and receives from one other, downwards;
  // so nobody is a hot spot. Both go round: after the last rank comes the first.
  std::array<OutgoingBytes, partners_at_a_time> outgoing;
  std::array<IncomingBytes, partners_at_a_time> incoming;
  std::array<MPI_Request, 2 * partners_at_a_time> requests;
  OutgoingBytes next{comm.rank(), own_data, send_counts[own]};
  IncomingBytes previous{comm.rank(), own_place, receive_counts[own]};
  for (int step = 1; step < ranks; step += static_cast<int>(partners_at_a_time)) {
    const auto partners = std::min(partners_at_a_time, static_cast<std::size_t>(ranks - step));
    for (std::size_t p = 0; p < partners; ++p) {
      next.data += offset_bytes(next.count, element_bytes);
      if (++next.rank == ranks)
        next = {0, send, 0};
      next.count = send_counts[static_cast<std::size_t>(next.rank)];
      outgoing[p] = next;

      if (--previous.rank < 0)
        previous = {ranks - 1, receive + bytes_of(receive_counts), 0};
      previous.count = receive_counts[static_cast<std::size_t>(previous.rank)];
      previous.data -= offset_bytes(previous.count, element_bytes);
      incoming[p] = previous;
    }
    transfer(comm, element_bytes, exchange_tag, std::span(incoming).first(partners),
             std::span(outgoing).first(partners), requests);
  }
}

void broadcast(const Communicator &comm, std::size_t element_bytes, std::byte *data, std::int64_t count,
               int root) {
  const ElementType type(element_bytes);
  const std::int64_t limit = elements_of_a_chunk(comm, element_bytes);
  for (std::int64_t first = 0; first < count; first += limit) {
    const std::int64_t length = std::min(limit, count - first);
    MPI_Bcast(data + offset_bytes(first, element_bytes), static_cast<int>(length), type, root, comm.raw());
    traffic::count_broadcast(comm, offset_bytes(length, element_bytes), root);
  }
}

void gather(const Communicator &comm, std::size_t element_bytes, const std::byte *send, std::int64_t count,
            std::byte *receive, std::span<const std::int64_t> receive_counts, int root) {
  std::array<MPI_Request, partners_at_a_time> requests;
  if (comm.rank() != root) {
    const OutgoingBytes letter{root, send, count};
    return transfer(comm, element_bytes, gather_tag, {}, {&letter, 1}, requests);
  }
  std::array<IncomingBytes, partners_at_a_time> incoming;
  std::size_t partners = 0;
  for (int from = 0; from < comm.size(); ++from) {
    const std::int64_t arriving = receive_counts[static_cast<std::size_t>(from)];
    if (from == root)
      copy_own(receive, send, offset_bytes(count, element_bytes));
    else
      incoming[partners++] = {from, receive, arriving};
    receive += offset_bytes(arriving, element_bytes);
    if (partners == partners_at_a_time || from + 1 == comm.size()) {
      transfer(comm, element_bytes, gather_tag, std::span(incoming).first(partners), {}, requests);
      partners = 0;
    }
  }
}

void announce(const Communicator &comm, SparseRound &round) {
  // A rank that has left this exchange may already announce something in the next one while another still
  // listens to this one. It cannot be two ahead, so two alternating tags tell them apart.
  const int tag = comm.next_sparse_round() % 2 == 0 ? sparse_count_tag : sparse_count_tag_odd;
  std::vector<MPI_Request> announcements;
  // A rank without memory for this goes on listening: the others count on being heard.
  const auto attempt = [&](auto &&work) {
    try {
      work();
    } catch (...) {
      round.failure = std::current_exception();
    }
  };
  attempt([&] { announcements.reserve(round.outgoing.size()); });
  for (const OutgoingBytes &letter : round.outgoing) {
    if (announcements.size() == announcements.capacity())
      break; // for want of memory, see above
    if (letter.rank == comm.rank()) {
      attempt([&] { round.incoming.push_back({letter.rank, nullptr, letter.count}); });
      continue;
    }
    MPI_Issend(&letter.count, 1, MPI_INT64_T, letter.rank, tag, comm.raw(), &announcements.emplace_back());
    comm.traffic().messages_sent += 1;
    comm.traffic().bytes_sent += static_cast<std::int64_t>(sizeof letter.count);
  }

  MPI_Request barrier = MPI_REQUEST_NULL;
  for (bool all_heard = false; !all_heard;) {
    int announced = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, tag, comm.raw(), &announced, &status);
    if (announced != 0) {
      std::int64_t count = 0;
      MPI_Recv(&count, 1, MPI_INT64_T, status.MPI_SOURCE, tag, comm.raw(), MPI_STATUS_IGNORE);
      attempt([&] { round.incoming.push_back({status.MPI_SOURCE, nullptr, count}); });
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
  std::sort(round.incoming.begin(), round.incoming.end(),
            [](const IncomingBytes &a, const IncomingBytes &b) { return a.rank < b.rank; });
}

void deliver(const Communicator &comm, std::size_t element_bytes, SparseRound &round) {
  // What goes to this rank itself needs no message.
  const auto to_own = std::ranges::find(round.outgoing, comm.rank(), &OutgoingBytes::rank);
  const auto from_own = std::ranges::find(round.incoming, comm.rank(), &IncomingBytes::rank);
  assert((to_own == round.outgoing.end()) == (from_own == round.incoming.end()));
  if (from_own != round.incoming.end()) {
    copy_own(from_own->data, to_own->data, offset_bytes(to_own->count, element_bytes));
    from_own->count = to_own->count = 0;
  }
  transfer(comm, element_bytes, sparse_data_tag, round.incoming, round.outgoing, round.requests);
}

std::string arriving_text(std::int64_t count, std::size_t element_bytes) {
  return fmt::format("{:.1f} MiB that other ranks send",
                     static_cast<double>(count) * static_cast<double>(element_bytes) / (1 << 20));
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
