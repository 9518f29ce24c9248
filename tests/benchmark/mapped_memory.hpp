/// Memory whose pages are mapped before anything is measured. What a fresh page costs is a matter of the
/// machine: where it is a virtual one, as much as triangulating a point, and ten times that from one minute
/// to the next.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace dovetail::benchmark {

/// From now on memory that is freed stays with the process, so that what comes after finds its pages mapped.
inline void keep_memory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, -1);
#endif
}

/// As above, beginning with `bytes` that are touched at once.
inline void keep_mapped_memory(std::size_t bytes) {
  keep_memory();
  void *const memory = std::malloc(bytes);
  if (memory == nullptr)
    throw std::bad_alloc();
  constexpr std::size_t page = 4096;
  auto *const touched = static_cast<volatile std::byte *>(memory); // or a compiler leaves it all out
  for (std::size_t i = 0; i < bytes; i += page)
    touched[i] = std::byte{1};
  std::free(memory);
}

} // namespace dovetail::benchmark
