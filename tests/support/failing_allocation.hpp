// Memory that does not suffice, at will: failing_allocation.cpp replaces operator new.
#pragma once

#include <cstddef>
#include <cstdint>

namespace dovetail::testing {

/// While it lives, of this process's allocations of `at_least` bytes or more the one numbered `which` (from
/// 0) throws std::bad_alloc.
class FailingAllocation {
public:
  FailingAllocation(std::size_t at_least, std::int64_t which);
  ~FailingAllocation();
  FailingAllocation(const FailingAllocation &) = delete;
  FailingAllocation &operator=(const FailingAllocation &) = delete;

  /// Whether it has thrown.
  static bool has_struck();
};

} // namespace dovetail::testing
