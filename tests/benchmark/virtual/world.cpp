#include "world.hpp"

#include <algorithm>
#include <cstring>
#include <ctime>
#include <numeric>
#include <stdexcept>
#include <type_traits>

namespace dovetail::virtual_ranks {
namespace {

World *current_world = nullptr; // MPI's functions have no other way to know

double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

std::size_t index(int i) { return static_cast<std::size_t>(i); }

bool fits(int wanted_source, int wanted_tag, const Letter &letter) {
  return (wanted_source == MPI_ANY_SOURCE || wanted_source == letter.source) &&
         (wanted_tag == MPI_ANY_TAG || wanted_tag == letter.tag);
}

std::shared_ptr<Group> group_of_all(int ranks) {
  std::vector<int> members(index(ranks));
  std::iota(members.begin(), members.end(), 0);
  return std::make_shared<Group>(std::move(members));
}

// Handles of requests are numbers in disguise: pointers with some MPIs, integers with others.
template <class Handle> Handle disguised(std::uint64_t number) {
  if constexpr (std::is_pointer_v<Handle>)
    return reinterpret_cast<Handle>(number);
  else
    return static_cast<Handle>(number);
}
template <class Handle> std::uint64_t undisguised(Handle handle) {
  if constexpr (std::is_pointer_v<Handle>)
    return reinterpret_cast<std::uint64_t>(handle);
  else
    return static_cast<std::uint64_t>(handle);
}

} // namespace

double Meeting::last_arrival() const { return *std::max_element(clock.begin(), clock.end()); }

World::World(int ranks, const Network &network, std::function<void(int)> program)
    : network_(network), ranks_(index(ranks)), fibers_(ranks, [this, program = std::move(program)](int rank) {
        start_working();
        program(rank);
        stop_working();
      }) {
  const auto all = group_of_all(ranks);
  for (int rank = 0; rank < ranks; ++rank)
    ranks_[index(rank)].world = {all, rank, 0};
}

World::~World() { current_world = nullptr; }

World *World::current() { return current_world; }

void World::run() {
  current_world = this;
  struct AtEnd {
    ~AtEnd() { current_world = nullptr; }
  } const at_end;
  fibers_.run();
}

void World::start_working() { working_since_ = processor_seconds(); }

void World::stop_working() {
  if (here().idle)
    return;
  const double worked = processor_seconds() - working_since_;
  here().time.clock += worked;
  here().time.worked += worked;
}

Time World::time() {
  const Call reading(*this);
  return here().time;
}

void World::restart_clock() {
  const Call call(*this);
  Rank &rank = here();
  rank.time = {};
  rank.sending_until = rank.receiving_until = 0;
}

Membership &World::membership(MPI_Comm comm) {
  if (comm == MPI_COMM_WORLD)
    return here().world;
  const auto found = memberships_.find(comm);
  if (found == memberships_.end())
    throw std::logic_error("a communicator that is not of virtual ranks");
  return found->second;
}

MPI_Comm World::join(std::shared_ptr<Group> group, int rank) {
  // A real one, so that what needs no partner (packing, attributes, error handlers) can be left to MPI.
  MPI_Comm handle = MPI_COMM_NULL;
  PMPI_Comm_dup(MPI_COMM_SELF, &handle);
  memberships_[handle] = {std::move(group), rank, 0};
  return handle;
}

void World::forget(MPI_Comm comm) { memberships_.erase(comm); }

std::shared_ptr<Meeting> World::meet(MPI_Comm comm, const Part &part,
                                     const std::function<void(Meeting &)> &work, bool waits) {
  Membership &member = membership(comm);
  Group &group = *member.group;
  const std::int64_t number = member.collective_calls++;
  std::shared_ptr<Meeting> &entry = group.meetings[number];
  if (!entry) {
    entry = std::make_shared<Meeting>();
    entry->parts.resize(group.members.size());
    entry->clock.resize(group.members.size());
    entry->groups.resize(group.members.size());
  }
  const std::shared_ptr<Meeting> meeting = entry;
  const int rank = member.rank;
  meeting->parts[index(rank)] = part;
  meeting->clock[index(rank)] = here().time.clock;
  if (++meeting->arrived == group.size()) {
    group.meetings.erase(number);
    work(*meeting);
    meeting->complete = true;
    for (const int waiting : meeting->waiting)
      fibers_.wake(waiting);
  } else {
    meeting->waiting.push_back(fibers_.current());
  }
  if (waits) {
    while (!meeting->complete)
      fibers_.sleep();
    here().time.clock = std::max(here().time.clock, meeting->clock[index(rank)]);
  }
  here().idle = false;
  return meeting;
}

void World::deliver(Request &request, const Letter &letter) {
  if (static_cast<std::int64_t>(letter.data.size()) > request.bytes)
    throw std::logic_error("a message is longer than the receive for it");
  std::copy(letter.data.begin(), letter.data.end(), request.buffer);
  request.complete = true;
  request.when = letter.sent;
  request.bytes = static_cast<std::int64_t>(letter.data.size());
  request.source = letter.source;
  request.tag = letter.tag;
  fibers_.wake(request.owner);
  if (Request *const sent = letter.acknowledged.get()) {
    sent->complete = true;
    sent->when = std::max(letter.sent + network_.latency_s, ranks_[index(request.owner)].time.clock) +
                 network_.latency_s;
    fibers_.wake(sent->owner);
  }
}

std::shared_ptr<Request> World::send(MPI_Comm comm, const void *data, std::int64_t bytes, int to, int tag,
                                     bool synchronous) {
  const Membership &member = membership(comm);
  Rank &sender = here();
  sender.time.clock += network_.overhead_s;
  sender.sending_until = std::max(sender.time.clock, sender.sending_until) + network_.transfer(bytes);

  auto request = std::make_shared<Request>();
  request->owner = fibers_.current();
  request->when = sender.sending_until;
  request->complete = !synchronous;
  const auto *const first = static_cast<const std::byte *>(data);
  Letter letter{
      member.rank, tag, {first, first + bytes}, sender.sending_until, synchronous ? request : nullptr};
  Group::Mailbox &mailbox = member.group->mailboxes[index(to)];
  const auto taker = std::find_if(mailbox.receives.begin(), mailbox.receives.end(), [&](const auto &waiting) {
    return fits(waiting->source, waiting->tag, letter);
  });
  if (taker == mailbox.receives.end()) {
    mailbox.letters.push_back(std::move(letter));
  } else {
    deliver(**taker, letter);
    mailbox.receives.erase(taker);
  }
  sender.idle = false;
  return request;
}

std::shared_ptr<Request> World::receive(MPI_Comm comm, void *buffer, std::int64_t bytes, int source,
                                        int tag) {
  const Membership &member = membership(comm);
  auto request = std::make_shared<Request>();
  request->owner = fibers_.current();
  request->receives = true;
  request->buffer = static_cast<std::byte *>(buffer);
  request->bytes = bytes;
  request->source = source;
  request->tag = tag;
  Group::Mailbox &mailbox = member.group->mailboxes[index(member.rank)];
  const auto letter = std::find_if(mailbox.letters.begin(), mailbox.letters.end(),
                                   [&](const Letter &waiting) { return fits(source, tag, waiting); });
  if (letter == mailbox.letters.end()) {
    mailbox.receives.push_back(request);
  } else {
    deliver(*request, *letter);
    mailbox.letters.erase(letter);
  }
  here().idle = false;
  return request;
}

const Letter *World::find(MPI_Comm comm, int source, int tag) {
  const Membership &member = membership(comm);
  const auto &letters = member.group->mailboxes[index(member.rank)].letters;
  const auto found = std::find_if(letters.begin(), letters.end(),
                                  [&](const Letter &waiting) { return fits(source, tag, waiting); });
  if (found == letters.end()) {
    idle();
    return nullptr;
  }
  here().idle = false;
  return &*found;
}

bool World::is_complete(Request &request) {
  if (request.meeting && request.meeting->complete) {
    request.complete = true;
    request.when = request.meeting->clock[index(request.rank)];
  }
  return request.complete;
}

void World::await(Request &request) {
  while (!is_complete(request))
    fibers_.sleep();
}

void World::take(const Request &request) {
  Rank &rank = here();
  double when = request.when;
  if (request.receives) {
    // A link takes one message at a time; the two links of a message work at the same time.
    when = rank.receiving_until =
        std::max(request.when + network_.latency_s, rank.receiving_until + network_.transfer(request.bytes));
  }
  rank.time.clock = std::max(rank.time.clock, when) + (request.receives ? network_.overhead_s : 0);
  rank.idle = false;
}

void World::idle() {
  here().idle = true;
  fibers_.pause();
}

MPI_Request World::handle_of(std::shared_ptr<Request> request) {
  requests_[next_request_] = std::move(request);
  return disguised<MPI_Request>(next_request_++);
}

Request &World::request_of(MPI_Request handle) { return *requests_.at(undisguised(handle)); }

void World::forget(MPI_Request handle) { requests_.erase(undisguised(handle)); }

} // namespace dovetail::virtual_ranks
