/// Several threads of control in one process, one of which runs until it gives way. All Local, and in an
/// order that depends on nothing but who gives way to whom.
#pragma once

#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <ucontext.h>
#include <vector>

namespace dovetail::virtual_ranks {

class Fibers {
public:
  /// `body` is called with the number of each fiber, on a stack of its own.
  Fibers(int count, std::function<void(int)> body);
  ~Fibers();
  Fibers(const Fibers &) = delete;
  Fibers &operator=(const Fibers &) = delete;

  /// Returns when all have ended; at the first exception that leaves a body, throws it. Throws
  /// std::logic_error where all that are left wait for each other.
  void run();

  /// For the running fiber: lets all others that can run have their turn first.
  void pause();
  /// For the running fiber: until somebody wakes it.
  void sleep();
  void wake(int fiber);
  int current() const { return current_; }

private:
  struct Fiber {
    ucontext_t context;
    std::byte *stack = nullptr;
    bool asleep = false;
    bool ended = false;
  };
  static void enter(unsigned high, unsigned low);
  void leave();

  std::function<void(int)> body_;
  std::vector<std::unique_ptr<Fiber>> fibers_;
  std::deque<int> ready_;
  ucontext_t scheduler_;
  int current_ = 0;
  std::exception_ptr failure_;
};

} // namespace dovetail::virtual_ranks
