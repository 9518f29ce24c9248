#include "process_memory.hpp"

#include <cstdlib>
#include <limits>
#include <new>
#include <utility>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace dovetail::cli {
namespace {

constexpr std::size_t reserve_bytes = std::size_t{8} << 20;
void *reserve = nullptr; // of the process, as the new-handler is

/// Returning from here means: try again.
void give_up_reserve() {
  if (reserve == nullptr)
    throw std::bad_alloc();
  std::free(std::exchange(reserve, nullptr));
}

} // namespace

void keep_memory_reserve() {
  reserve = std::malloc(reserve_bytes); // never touched, so it costs addresses and no memory
  std::set_new_handler(give_up_reserve);
}

void keep_freed_memory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_MAX, 0); // no array has a mapping of its own, that would go with it
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
#endif
}

} // namespace dovetail::cli
