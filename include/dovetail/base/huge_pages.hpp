/// Memory for large arrays. A page of 4 KiB costs a fault when it is first touched, and an entry of the
/// processor's address cache whenever a sort or a mesh jumps to it: for arrays that are filled once and read
/// in any order, about a tenth of all time. Linux gives them pages of 2 MiB when asked.
#pragma once

#include <cstddef>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

namespace dovetail {

/// Local. Advice, and without effect where it is not understood. Memory that has been touched stays as it is.
void advise_huge_pages(void *begin, std::size_t bytes);

/// Local. values.reserve(count). What there is moves into the new room after the advice, which would come too
/// late for pages that reserve() itself has touched.
template <class Value> void reserve_huge(std::vector<Value> &values, std::size_t count) {
  if (count <= values.capacity())
    return;
  std::vector<Value> roomier;
  roomier.reserve(count);
  advise_huge_pages(roomier.data(), roomier.capacity() * sizeof(Value));
  roomier.insert(roomier.end(), std::make_move_iterator(values.begin()),
                 std::make_move_iterator(values.end()));
  values = std::move(roomier);
}

/// Local. An array whose values are not set.
template <class Value> std::unique_ptr<Value[]> make_huge_for_overwrite(std::size_t count) {
  auto values = std::make_unique_for_overwrite<Value[]>(count);
  advise_huge_pages(values.get(), count * sizeof(Value));
  return values;
}

} // namespace dovetail
