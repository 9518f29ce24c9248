#include "interrupt.hpp"

#include "progress.hpp"
#include "text.hpp"

#include "dovetail/io/output_file.hpp"

#include <fmt/format.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <fcntl.h>
#include <string>
#include <system_error>
#include <unistd.h>
#include <vector>

namespace dovetail::cli {
namespace {

constexpr std::array<int, 3> watched_signals{SIGINT, SIGTERM, SIGHUP};
// For the rank that tells, which also has the files: as soon as one rank is dead, mpirun kills the others.
constexpr std::chrono::milliseconds head_start(300);

// A handler of signals is told nothing else.
std::atomic<int> pipe_to_watch{-1};
static_assert(std::atomic<int>::is_always_lock_free, "what a handler of signals reads");

void pass_on(int signal) {
  const int error_number = errno;
  const auto byte = static_cast<unsigned char>(signal);
  [[maybe_unused]] const ssize_t written = ::write(pipe_to_watch.load(), &byte, 1);
  errno = error_number;
}

[[noreturn]] void die_of(int signal) {
  std::signal(signal, SIG_DFL);
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, signal);
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
  std::raise(signal);
  ::_exit(128 + signal);
}

void end_run(bool tells) {
  const std::vector<std::string> written = abandon_outputs();
  const std::string stage = silence_progress();
  if (!tells) {
    std::this_thread::sleep_for(head_start);
    return;
  }
  fmt::print(stderr, "dovetail: interrupted{}; {}\n", stage.empty() ? "" : " during " + stage,
             written.empty() ? "nothing was written" : joined(written, " and ") + " had been written");
  std::fflush(stderr);
}

} // namespace

InterruptWatch::InterruptWatch(bool tells) : tells_(tells) {
  if (::pipe2(pipe_, O_CLOEXEC) != 0)
    throw std::system_error(errno, std::generic_category(), "a pipe for signals");
  pipe_to_watch = pipe_[1];
  thread_ = std::thread([this] { wait_for_signal(); });
  for (const int signal : watched_signals) {
    struct sigaction action = {};
    sigaction(signal, nullptr, &action);
    if (action.sa_handler == SIG_IGN)
      continue;
    action = {};
    action.sa_handler = pass_on;
    action.sa_flags = SA_RESTART; // nothing in the run notices
    sigaction(signal, &action, nullptr);
  }
}

InterruptWatch::~InterruptWatch() {
  for (const int signal : watched_signals) {
    struct sigaction action = {};
    sigaction(signal, nullptr, &action);
    if (action.sa_handler == pass_on)
      std::signal(signal, SIG_DFL);
  }
  pass_on(0);
  thread_.join();
  pipe_to_watch = -1;
  ::close(pipe_[0]);
  ::close(pipe_[1]);
}

void InterruptWatch::wait_for_signal() const {
  unsigned char signal = 0;
  while (::read(pipe_[0], &signal, 1) < 0 && errno == EINTR)
    continue;
  if (signal == 0)
    return;
  try {
    end_run(tells_);
  } catch (const std::exception &) { // no memory for the words
  }
  die_of(signal);
}

} // namespace dovetail::cli
