#include "fibers.hpp"

#include <cstdint>
#include <stdexcept>
#include <sys/mman.h>
#include <system_error>

namespace dovetail::virtual_ranks {
namespace {

/// Of address space; memory is taken as it is used. The pipeline recurses by sizes and by digits of keys.
constexpr std::size_t stack_bytes = std::size_t{1} << 21;

std::byte *new_stack() {
  void *const memory = mmap(nullptr, stack_bytes, PROT_READ | PROT_WRITE,
                            MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE | MAP_STACK, -1, 0);
  if (memory == MAP_FAILED)
    throw std::system_error(errno, std::generic_category(), "a stack for a virtual rank");
  mprotect(memory, 4096, PROT_NONE); // whoever needs more than a stack has must not find another's
  return static_cast<std::byte *>(memory);
}

} // namespace

Fibers::Fibers(int count, std::function<void(int)> body) : body_(std::move(body)) {
  const auto self = reinterpret_cast<std::uintptr_t>(this); // makecontext passes ints only
  for (int f = 0; f < count; ++f) {
    Fiber &fiber = *fibers_.emplace_back(std::make_unique<Fiber>());
    fiber.stack = new_stack();
    getcontext(&fiber.context);
    fiber.context.uc_stack.ss_sp = fiber.stack;
    fiber.context.uc_stack.ss_size = stack_bytes;
    fiber.context.uc_link = nullptr;
    makecontext(&fiber.context, reinterpret_cast<void (*)()>(&Fibers::enter), 2,
                static_cast<unsigned>(self >> 32), static_cast<unsigned>(self));
    ready_.push_back(f);
  }
}

Fibers::~Fibers() {
  for (const auto &fiber : fibers_)
    munmap(fiber->stack, stack_bytes);
}

void Fibers::enter(unsigned high, unsigned low) {
  auto &self = *reinterpret_cast<Fibers *>((std::uintptr_t{high} << 32) | low);
  try {
    self.body_(self.current_);
  } catch (...) {
    self.failure_ = std::current_exception();
  }
  self.fibers_[static_cast<std::size_t>(self.current_)]->ended = true;
  self.leave();
}

void Fibers::leave() { swapcontext(&fibers_[static_cast<std::size_t>(current_)]->context, &scheduler_); }

void Fibers::run() {
  while (!ready_.empty()) {
    current_ = ready_.front();
    ready_.pop_front();
    Fiber &fiber = *fibers_[static_cast<std::size_t>(current_)];
    swapcontext(&scheduler_, &fiber.context);
    if (failure_)
      std::rethrow_exception(failure_);
    if (fiber.ended)
      madvise(fiber.stack + 4096, stack_bytes - 4096, MADV_DONTNEED);
  }
  for (const auto &fiber : fibers_)
    if (!fiber->ended)
      throw std::logic_error("virtual ranks wait for each other for ever");
}

void Fibers::pause() {
  ready_.push_back(current_);
  leave();
}

void Fibers::sleep() {
  fibers_[static_cast<std::size_t>(current_)]->asleep = true;
  leave();
}

void Fibers::wake(int fiber) {
  Fiber &sleeper = *fibers_[static_cast<std::size_t>(fiber)];
  if (!sleeper.asleep)
    return;
  sleeper.asleep = false;
  ready_.push_back(fiber);
}

} // namespace dovetail::virtual_ranks
