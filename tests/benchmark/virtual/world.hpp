/// Any number of ranks in one process, one after another: a program that was written for MPI runs on each of
/// them, unchanged, its calls to MPI being answered here (mpi_calls.cpp). What they say to each other really
/// arrives. Every rank has a clock: it advances by the processor time that its own work takes, and by what a
/// modelled network takes for its messages; whoever waits advances to when the awaited is there. So many
/// ranks on few processors show the time that as many processors would have taken.
///
/// In the manner of SMPI (Clauss and others, 2011: Single node on-line simulation of MPI applications), with
/// one thread, no routing and no contention between links.
#pragma once

#include "fibers.hpp"
#include "network.hpp"

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <unordered_map>
#include <vector>

namespace dovetail::virtual_ranks {

/// What one rank brings to a collective call, and where it wants the result. Counts are in bytes.
struct Part {
  const std::byte *send = nullptr;
  std::byte *receive = nullptr;
  std::int64_t bytes = 0;
  const int *receive_counts = nullptr; ///< in elements of one byte, for the root of a Gatherv
  const int *displacements = nullptr;
  int color = 0, key = 0; ///< of a split
};

struct Group;

/// A collective call of all ranks of a group. The last to arrive does the work of all.
struct Meeting {
  std::vector<Part> parts;                    ///< by rank
  std::vector<double> clock;                  ///< when each arrives, and then when it leaves
  std::vector<std::shared_ptr<Group>> groups; ///< for calls that make communicators
  std::vector<int> waiting;                   ///< ranks of the world
  int arrived = 0;
  bool complete = false;

  double last_arrival() const;
  void all_leave(double when) { clock.assign(clock.size(), when); }
};

/// A message or a synchronising call under way, as the one who waits for it sees it.
struct Request {
  bool complete = false;
  double when = 0; ///< it was complete; of a receive, its last byte left the sender
  bool receives = false;
  std::byte *buffer = nullptr; ///< of a receive, with room for so many bytes
  std::int64_t bytes = 0;
  int source = MPI_ANY_SOURCE, tag = MPI_ANY_TAG;
  int owner = 0;                    ///< rank of the world
  std::shared_ptr<Meeting> meeting; ///< of a non-blocking barrier
  int rank = 0;                     ///< in the meeting
};

struct Letter {
  int source, tag;
  std::vector<std::byte> data;
  double sent;                           ///< its last byte
  std::shared_ptr<Request> acknowledged; ///< the sender's, if it wants to know that it was received
};

/// The ranks that share a communicator.
struct Group {
  struct Mailbox {
    std::vector<Letter> letters;
    std::vector<std::shared_ptr<Request>> receives;
  };
  std::vector<int> members; ///< ranks of the world
  std::vector<Mailbox> mailboxes;
  std::map<std::int64_t, std::shared_ptr<Meeting>> meetings; ///< by the number of the collective call

  explicit Group(std::vector<int> ranks) : members(std::move(ranks)), mailboxes(members.size()) {}
  int size() const { return static_cast<int>(members.size()); }
};

/// What a handle of one rank stands for.
struct Membership {
  std::shared_ptr<Group> group;
  int rank = 0;
  std::int64_t collective_calls = 0;
};

/// Seconds of a rank: on its clock, and of its own work, which its clock has counted too.
struct Time {
  double clock = 0;
  double worked = 0;
};

/// The ranks, their clocks, and what is under way between them.
class World {
public:
  World(int ranks, const Network &network, std::function<void(int rank)> program);
  ~World();
  World(const World &) = delete;
  World &operator=(const World &) = delete;

  /// The world that MPI's functions speak for now; null outside run(), when they are MPI's own.
  static World *current();
  void run();

  /// Of the running rank.
  Time time();
  /// The running rank starts anew at zero, as if its work so far had not been.
  void restart_clock();

  const Network &network() const { return network_; }
  Membership &membership(MPI_Comm comm);
  /// A handle of the running rank.
  MPI_Comm join(std::shared_ptr<Group> group, int rank);
  void forget(MPI_Comm comm);

  /// The running rank enters and leaves MPI: only what is between two calls is its own work.
  class Call {
  public:
    explicit Call(World &world) : world_(world) { world_.stop_working(); }
    ~Call() { world_.start_working(); }
    Call(const Call &) = delete;
    Call &operator=(const Call &) = delete;

  private:
    World &world_;
  };

  // Within a Call.
  /// `work` is done once, by the last rank to arrive, and sets when each may leave.
  std::shared_ptr<Meeting> meet(MPI_Comm comm, const Part &part, const std::function<void(Meeting &)> &work,
                                bool waits = true);
  std::shared_ptr<Request> send(MPI_Comm comm, const void *data, std::int64_t bytes, int to, int tag,
                                bool synchronous);
  std::shared_ptr<Request> receive(MPI_Comm comm, void *buffer, std::int64_t bytes, int source, int tag);
  /// The first letter of its kind for the running rank; none after looking in vain, see idle().
  const Letter *find(MPI_Comm comm, int source, int tag);
  static bool is_complete(Request &request);
  void await(Request &request);
  /// The running rank sees a complete request, not before it was complete. Its link inwards takes one message
  /// at a time: of several that are waited for together, in the order in which they were sent.
  void take(const Request &request);
  /// The running rank looked in vain: the others have their turn, and looking is not work.
  void idle();

  MPI_Request handle_of(std::shared_ptr<Request> request);
  Request &request_of(MPI_Request handle);
  void forget(MPI_Request handle);

private:
  struct Rank {
    Time time;
    bool idle = false;
    double sending_until = 0;   ///< its link outwards is taken
    double receiving_until = 0; ///< inwards
    Membership world;
  };
  void start_working();
  void stop_working();
  Rank &here() { return ranks_[static_cast<std::size_t>(fibers_.current())]; }
  void deliver(Request &request, const Letter &letter);

  Network network_;
  std::vector<Rank> ranks_;
  std::unordered_map<MPI_Comm, Membership> memberships_;
  std::unordered_map<std::uint64_t, std::shared_ptr<Request>> requests_;
  std::uint64_t next_request_ = 1;
  double working_since_ = 0;
  Fibers fibers_;
};

} // namespace dovetail::virtual_ranks
