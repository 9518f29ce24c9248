/// Ctrl-C and its kin: the run ends at once, leaves nothing half done, and says so.
#pragma once

#include <thread>

namespace dovetail::cli {

/// While it lives, SIGINT, SIGTERM and SIGHUP end the process from a thread of its own, whatever the main
/// thread is doing, be it waiting inside MPI or for a disk: what is kept aside is removed, one line says in
/// which stage the run was, and the process dies of the signal, as whoever sent it expects. A signal that was
/// ignored before, as under nohup, stays ignored.
///
/// On many ranks each does so for itself: no rank needs another one to end. If only some get the signal,
/// their death makes the launcher send SIGTERM to the rest. Ranks
/// that do not tell die a third of a second later: a launcher that sees one rank dead may kill the one that
/// has the files before it has removed them.
///
/// Local. One at a time in a process.
class InterruptWatch {
public:
  /// `tells`: this rank says the line.
  explicit InterruptWatch(bool tells);
  InterruptWatch(const InterruptWatch &) = delete;
  InterruptWatch &operator=(const InterruptWatch &) = delete;
  /// From here on these signals act as they did before. Does not return if one has come already.
  ~InterruptWatch();

private:
  void wait_for_signal() const;

  const bool tells_;
  int pipe_[2] = {-1, -1}; // the signals that have come, one byte each; 0 is the end of the watch
  std::thread thread_;
};

} // namespace dovetail::cli
