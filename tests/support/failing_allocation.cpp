#include "support/failing_allocation.hpp"

#include <atomic>
#include <cstdlib>
#include <limits>
#include <new>

namespace dovetail::testing {
namespace {

constexpr std::size_t never = std::numeric_limits<std::size_t>::max();
std::atomic<std::size_t> smallest = never; ///< that counts
std::atomic<std::int64_t> until_failure = 0;
std::atomic<bool> struck = false;

/// Whether an allocation of this size must fail.
bool strikes(std::size_t bytes) {
  if (bytes < smallest || until_failure-- != 0)
    return false;
  struck = true;
  return true;
}

} // namespace

FailingAllocation::FailingAllocation(std::size_t at_least, std::int64_t which) {
  struck = false;
  until_failure = which;
  smallest = at_least;
}
FailingAllocation::~FailingAllocation() { smallest = never; }
bool FailingAllocation::has_struck() { return struck; }

} // namespace dovetail::testing

void *operator new(std::size_t bytes) {
  if (dovetail::testing::strikes(bytes))
    throw std::bad_alloc();
  if (void *memory = std::malloc(bytes > 0 ? bytes : 1))
    return memory;
  throw std::bad_alloc();
}
void operator delete(void *memory) noexcept { std::free(memory); }
void operator delete(void *memory, std::size_t) noexcept { std::free(memory); }
