#include "memory_reserve.hpp"

#include <cstdlib>
#include <new>
#include <utility>

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

} // namespace dovetail::cli
