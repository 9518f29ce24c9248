#include "dovetail/base/huge_pages.hpp"

#ifdef __linux__
#include <cstddef>
#include <cstdint>
#include <sys/mman.h>
#include <unistd.h>
#endif

namespace dovetail {

void advise_huge_pages([[maybe_unused]] void *begin, [[maybe_unused]] std::size_t bytes) {
#if defined(__linux__) && defined(MADV_HUGEPAGE)
  // Arrays that would not fill a few of them are not worth the call, nor what lies beside them in the heap.
  constexpr std::size_t worth = std::size_t{4} << 20;
  if (bytes < worth)
    return;
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const std::size_t before = (page - reinterpret_cast<std::uintptr_t>(begin) % page) % page;
  madvise(static_cast<std::byte *>(begin) + before, (bytes - before) / page * page, MADV_HUGEPAGE);
#endif
}

} // namespace dovetail
