// The functions of MPI that the pipeline calls, by itself or through Boost.MPI, answered by World for the
// running virtual rank. They take the place of the library's own, which remain reachable with the prefix PMPI
// for what needs no partner: datatypes, packing, reduction of two operands.
#include "world.hpp"

#include <algorithm>
#include <cstring>
#include <map>
#include <stdexcept>
#include <vector>

namespace {

using namespace dovetail::virtual_ranks;

std::size_t index(int i) { return static_cast<std::size_t>(i); }
const std::byte *bytes(const void *data) { return static_cast<const std::byte *>(data); }
std::byte *bytes(void *data) { return static_cast<std::byte *>(data); }

/// Elements lie one after another without gaps, as all of the pipeline's do.
std::int64_t size_of(int count, MPI_Datatype type) {
  int size = 0;
  MPI_Aint lower = 0, extent = 0;
  PMPI_Type_size(type, &size);
  PMPI_Type_get_extent(type, &lower, &extent);
  if (lower != 0 || extent != size)
    throw std::logic_error("a datatype with gaps");
  return std::int64_t{count} * size;
}

void copy_bytes(std::byte *to, const std::byte *from, std::int64_t count) {
  if (count > 0)
    std::memmove(to, from, static_cast<std::size_t>(count));
}

void fill(MPI_Status *status, int source, int tag, std::int64_t count) {
  if (status == MPI_STATUS_IGNORE)
    return;
  status->MPI_SOURCE = source;
  status->MPI_TAG = tag;
  status->MPI_ERROR = MPI_SUCCESS;
  PMPI_Status_set_elements(status, MPI_BYTE, static_cast<int>(count));
}

bool is_complete(World &world, MPI_Request handle) {
  return handle == MPI_REQUEST_NULL || World::is_complete(world.request_of(handle));
}

/// A complete request is taken, and is gone.
void finish(World &world, MPI_Request &handle, MPI_Status *status) {
  if (handle == MPI_REQUEST_NULL)
    return;
  const Request &request = world.request_of(handle);
  world.take(request);
  if (request.receives)
    fill(status, request.source, request.tag, request.bytes);
  world.forget(handle);
  handle = MPI_REQUEST_NULL;
}

MPI_Status *status_at(MPI_Status *statuses, int i) {
  return statuses == MPI_STATUSES_IGNORE ? MPI_STATUS_IGNORE : statuses + i;
}

/// New groups for every color, in the order of keys and then of ranks.
void split(const Group &group, Meeting &meeting) {
  std::map<int, std::vector<int>> parts; // ranks by color
  for (int rank = 0; rank < group.size(); ++rank)
    if (meeting.parts[index(rank)].color != MPI_UNDEFINED)
      parts[meeting.parts[index(rank)].color].push_back(rank);
  for (auto &[color, ranks] : parts) {
    std::ranges::stable_sort(ranks, {}, [&](int rank) { return meeting.parts[index(rank)].key; });
    std::vector<int> members;
    for (const int rank : ranks)
      members.push_back(group.members[index(rank)]);
    const auto part = std::make_shared<Group>(std::move(members));
    for (std::size_t i = 0; i < ranks.size(); ++i) {
      meeting.groups[index(ranks[i])] = part;
      meeting.parts[index(ranks[i])].key = static_cast<int>(i); // its rank in the part
    }
  }
}

int divide(World &world, MPI_Comm comm, int color, int key, MPI_Comm *result) {
  const Membership member = world.membership(comm);
  const auto meeting =
      world.meet(comm, {nullptr, nullptr, 0, nullptr, nullptr, color, key}, [&](Meeting &all) {
        split(*member.group, all);
        all.all_leave(all.last_arrival() + world.network().all_gather(member.group->size(), 8));
      });
  const auto mine = index(member.rank);
  *result =
      color == MPI_UNDEFINED ? MPI_COMM_NULL : world.join(meeting->groups[mine], meeting->parts[mine].key);
  return MPI_SUCCESS;
}

/// Reduces up to every rank (a scan), or to the last and so for all.
void reduce(Meeting &all, int count, MPI_Datatype type, MPI_Op op, std::int64_t size, bool scan) {
  std::vector<std::byte> sum(all.parts.front().send, all.parts.front().send + size);
  std::vector<std::byte> own;
  for (std::size_t rank = 0; rank < all.parts.size(); ++rank) {
    if (rank > 0) { // MPI's order: the lower ranks are the left operand, and the result is in the right one
      own.assign(all.parts[rank].send, all.parts[rank].send + size);
      PMPI_Reduce_local(sum.data(), own.data(), count, type, op);
      sum.swap(own);
    }
    if (scan)
      copy_bytes(all.parts[rank].receive, sum.data(), size);
  }
  if (!scan)
    for (const Part &part : all.parts)
      copy_bytes(part.receive, sum.data(), size);
}

int reduction(const void *send, void *receive, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm,
              bool scan) {
  World &world = *World::current();
  const World::Call call(world);
  if (send == MPI_IN_PLACE)
    throw std::logic_error("MPI_IN_PLACE");
  const std::int64_t size = size_of(count, type);
  world.meet(comm, {bytes(send), bytes(receive), size, nullptr, nullptr, 0, 0}, [&](Meeting &all) {
    reduce(all, count, type, op, size, scan);
    const double time = world.network().all_reduce(static_cast<int>(all.parts.size()), size);
    all.all_leave(all.last_arrival() + time);
  });
  return MPI_SUCCESS;
}

int gathering(Part part, int root, MPI_Comm comm, bool same_length) {
  World &world = *World::current();
  world.meet(comm, part, [&](Meeting &all) {
    const Part &at_root = all.parts[index(root)];
    std::int64_t place = 0, of_others = 0;
    for (std::size_t rank = 0; rank < all.parts.size(); ++rank) {
      const Part &from = all.parts[rank];
      if (!same_length && at_root.receive_counts[rank] != from.bytes)
        throw std::logic_error("a gather of other lengths than were announced");
      copy_bytes(at_root.receive + (same_length ? place : at_root.displacements[rank]), from.send,
                 from.bytes);
      place += from.bytes;
      of_others += rank == index(root) ? 0 : from.bytes;
    }
    const double end =
        all.last_arrival() + world.network().gather(static_cast<int>(all.parts.size()), of_others);
    for (std::size_t rank = 0; rank < all.parts.size(); ++rank)
      all.clock[rank] = rank == index(root) ? end
                                            : all.clock[rank] + world.network().overhead_s +
                                                  world.network().transfer(all.parts[rank].bytes);
  });
  return MPI_SUCCESS;
}

} // namespace

extern "C" {

int MPI_Comm_size(MPI_Comm comm, int *size) {
  World *const world = World::current();
  if (world == nullptr)
    return PMPI_Comm_size(comm, size);
  *size = world->membership(comm).group->size();
  return MPI_SUCCESS;
}

int MPI_Comm_rank(MPI_Comm comm, int *rank) {
  World *const world = World::current();
  if (world == nullptr)
    return PMPI_Comm_rank(comm, rank);
  *rank = world->membership(comm).rank;
  return MPI_SUCCESS;
}

int MPI_Comm_dup(MPI_Comm comm, MPI_Comm *copy) {
  World &world = *World::current();
  const World::Call call(world);
  return divide(world, comm, 0, world.membership(comm).rank, copy);
}

int MPI_Comm_split(MPI_Comm comm, int color, int key, MPI_Comm *part) {
  World &world = *World::current();
  const World::Call call(world);
  return divide(world, comm, color, key, part);
}

/// All virtual ranks share the memory of this process.
int MPI_Comm_split_type(MPI_Comm comm, int type, int key, MPI_Info, MPI_Comm *part) {
  return MPI_Comm_split(comm, type == MPI_UNDEFINED ? MPI_UNDEFINED : 0, key, part);
}

int MPI_Comm_free(MPI_Comm *comm) {
  if (World *const world = World::current())
    world->forget(*comm);
  return PMPI_Comm_free(comm);
}

int MPI_Allreduce(const void *send, void *receive, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  return reduction(send, receive, count, type, op, comm, false);
}

int MPI_Scan(const void *send, void *receive, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  return reduction(send, receive, count, type, op, comm, true);
}

int MPI_Allgather(const void *send, int count, MPI_Datatype type, void *receive, int, MPI_Datatype,
                  MPI_Comm comm) {
  World &world = *World::current();
  const World::Call call(world);
  const std::int64_t size = size_of(count, type);
  world.meet(comm, {bytes(send), bytes(receive), size, nullptr, nullptr, 0, 0}, [&](Meeting &all) {
    std::vector<std::byte> together;
    for (const Part &part : all.parts)
      together.insert(together.end(), part.send, part.send + size);
    for (const Part &part : all.parts)
      copy_bytes(part.receive, together.data(), static_cast<std::int64_t>(together.size()));
    all.all_leave(all.last_arrival() + world.network().all_gather(static_cast<int>(all.parts.size()), size));
  });
  return MPI_SUCCESS;
}

int MPI_Alltoall(const void *send, int count, MPI_Datatype type, void *receive, int, MPI_Datatype,
                 MPI_Comm comm) {
  World &world = *World::current();
  const World::Call call(world);
  const std::int64_t size = size_of(count, type);
  world.meet(comm, {bytes(send), bytes(receive), size, nullptr, nullptr, 0, 0}, [&](Meeting &all) {
    const auto ranks = static_cast<std::int64_t>(all.parts.size());
    for (std::int64_t from = 0; from < ranks; ++from)
      for (std::int64_t to = 0; to < ranks; ++to)
        copy_bytes(all.parts[static_cast<std::size_t>(to)].receive + from * size,
                   all.parts[static_cast<std::size_t>(from)].send + to * size, size);
    all.all_leave(all.last_arrival() + world.network().all_to_all(static_cast<int>(ranks), size));
  });
  return MPI_SUCCESS;
}

int MPI_Bcast(void *data, int count, MPI_Datatype type, int root, MPI_Comm comm) {
  World &world = *World::current();
  const World::Call call(world);
  const std::int64_t size = size_of(count, type);
  world.meet(comm, {nullptr, bytes(data), size, nullptr, nullptr, 0, 0}, [&](Meeting &all) {
    const auto ranks = static_cast<int>(all.parts.size());
    const double start = all.clock[index(root)];
    const double end = start + world.network().broadcast(ranks, size);
    for (int rank = 0; rank < ranks; ++rank)
      if (rank != root) {
        copy_bytes(all.parts[index(rank)].receive, all.parts[index(root)].receive, size);
        all.clock[index(rank)] = std::max(all.clock[index(rank)], end);
      }
    if (ranks > 1) // the root is through when the last of its own messages is on its way
      all.clock[index(root)] = end - world.network().latency_s - world.network().overhead_s;
  });
  return MPI_SUCCESS;
}

int MPI_Gather(const void *send, int count, MPI_Datatype type, void *receive, int, MPI_Datatype, int root,
               MPI_Comm comm) {
  const World::Call call(*World::current());
  return gathering({bytes(send), bytes(receive), size_of(count, type), nullptr, nullptr, 0, 0}, root, comm,
                   true);
}

int MPI_Gatherv(const void *send, int count, MPI_Datatype type, void *receive, const int *counts,
                const int *displacements, MPI_Datatype, int root, MPI_Comm comm) {
  const World::Call call(*World::current());
  const std::int64_t size = size_of(count, type);
  if (size != count)
    throw std::logic_error("a Gatherv of other things than bytes");
  return gathering({bytes(send), bytes(receive), size, counts, displacements, 0, 0}, root, comm, false);
}

int MPI_Ibarrier(MPI_Comm comm, MPI_Request *request) {
  World &world = *World::current();
  const World::Call call(world);
  auto entered = std::make_shared<Request>();
  entered->rank = world.membership(comm).rank;
  const auto work = [&](Meeting &all) {
    all.all_leave(all.last_arrival() + world.network().all_reduce(static_cast<int>(all.parts.size()), 0));
  };
  entered->meeting = world.meet(comm, {}, work, false);
  *request = world.handle_of(std::move(entered));
  return MPI_SUCCESS;
}

int MPI_Isend(const void *data, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm,
              MPI_Request *request) {
  World &world = *World::current();
  const World::Call call(world);
  *request = world.handle_of(world.send(comm, data, size_of(count, type), to, tag, false));
  return MPI_SUCCESS;
}

int MPI_Issend(const void *data, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm,
               MPI_Request *request) {
  World &world = *World::current();
  const World::Call call(world);
  *request = world.handle_of(world.send(comm, data, size_of(count, type), to, tag, true));
  return MPI_SUCCESS;
}

int MPI_Irecv(void *data, int count, MPI_Datatype type, int source, int tag, MPI_Comm comm,
              MPI_Request *request) {
  World &world = *World::current();
  const World::Call call(world);
  *request = world.handle_of(world.receive(comm, data, size_of(count, type), source, tag));
  return MPI_SUCCESS;
}

int MPI_Recv(void *data, int count, MPI_Datatype type, int source, int tag, MPI_Comm comm,
             MPI_Status *status) {
  World &world = *World::current();
  const World::Call call(world);
  const auto request = world.receive(comm, data, size_of(count, type), source, tag);
  world.await(*request);
  world.take(*request);
  fill(status, request->source, request->tag, request->bytes);
  return MPI_SUCCESS;
}

int MPI_Iprobe(int source, int tag, MPI_Comm comm, int *found, MPI_Status *status) {
  World &world = *World::current();
  const World::Call call(world);
  const Letter *const letter = world.find(comm, source, tag);
  *found = letter != nullptr ? 1 : 0;
  if (letter != nullptr)
    fill(status, letter->source, letter->tag, static_cast<std::int64_t>(letter->data.size()));
  return MPI_SUCCESS;
}

int MPI_Test(MPI_Request *request, int *done, MPI_Status *status) {
  return MPI_Testall(1, request, done, status);
}

int MPI_Testall(int count, MPI_Request *requests, int *done, MPI_Status *statuses) {
  World &world = *World::current();
  const World::Call call(world);
  *done = std::all_of(requests, requests + count, [&](MPI_Request one) { return is_complete(world, one); });
  if (*done == 0)
    world.idle();
  for (int i = 0; *done != 0 && i < count; ++i)
    finish(world, requests[i], status_at(statuses, i));
  return MPI_SUCCESS;
}

int MPI_Waitall(int count, MPI_Request *requests, MPI_Status *statuses) {
  World &world = *World::current();
  const World::Call call(world);
  std::vector<int> order;
  for (int i = 0; i < count; ++i)
    if (requests[i] != MPI_REQUEST_NULL) {
      world.await(world.request_of(requests[i]));
      order.push_back(i);
    }
  std::ranges::stable_sort(order, {}, [&](int i) { return world.request_of(requests[i]).when; });
  for (const int i : order)
    finish(world, requests[i], status_at(statuses, i));
  return MPI_SUCCESS;
}

// Whatever else speaks to other ranks would be answered by MPI, which knows of this process alone.
#define REFUSED(name, parameters)                                                                            \
  int MPI_##name parameters { throw std::logic_error("MPI_" #name " is not known to virtual ranks"); }
// clang-format off
#define IN const void *, int, MPI_Datatype
REFUSED(Send, (IN, int, int, MPI_Comm))
REFUSED(Ssend, (IN, int, int, MPI_Comm))
REFUSED(Probe, (int, int, MPI_Comm, MPI_Status *))
REFUSED(Mprobe, (int, int, MPI_Comm, MPI_Message *, MPI_Status *))
REFUSED(Improbe, (int, int, MPI_Comm, int *, MPI_Message *, MPI_Status *))
REFUSED(Wait, (MPI_Request *, MPI_Status *))
REFUSED(Barrier, (MPI_Comm))
REFUSED(Reduce, (const void *, void *, int, MPI_Datatype, MPI_Op, int, MPI_Comm))
REFUSED(Exscan, (const void *, void *, int, MPI_Datatype, MPI_Op, MPI_Comm))
REFUSED(Allgatherv, (IN, void *, const int *, const int *, MPI_Datatype, MPI_Comm))
REFUSED(Alltoallv, (const void *, const int *, const int *, MPI_Datatype, void *, const int *, const int *, MPI_Datatype, MPI_Comm))
REFUSED(Scatter, (IN, void *, int, MPI_Datatype, int, MPI_Comm))
REFUSED(Scatterv, (const void *, const int *, const int *, MPI_Datatype, void *, int, MPI_Datatype, int, MPI_Comm))
REFUSED(Comm_create, (MPI_Comm, MPI_Group, MPI_Comm *))
#undef IN
// clang-format on
#undef REFUSED
}
