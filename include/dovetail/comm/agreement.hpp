/// Making one rank's problem everybody's before the next collective, so that nobody waits for ever.
#pragma once

#include "dovetail/base/error.hpp"
#include "dovetail/comm/communicator.hpp"

#include <optional>
#include <type_traits>
#include <utility>

namespace dovetail {

/// Collective. If any rank has a problem, every rank throws the same Error: that of the lowest such rank.
void agree(const Communicator &comm, const std::optional<Problem> &problem);

/// The problem that the exception being handled describes: an Error as it is, std::bad_alloc and
/// std::length_error as a lack of memory, any other std::exception by its text. For use inside catch (...).
Problem current_problem();

/// Collective. Runs `work`, which must itself be Local, and agrees on how it ended.
template <class Work> auto collectively(const Communicator &comm, Work &&work) {
  std::optional<Problem> problem;
  if constexpr (std::is_void_v<std::invoke_result_t<Work>>) {
    try {
      std::forward<Work>(work)();
    } catch (...) {
      problem = current_problem();
    }
    agree(comm, problem);
  } else {
    std::optional<std::invoke_result_t<Work>> result;
    try {
      result.emplace(std::forward<Work>(work)());
    } catch (...) {
      problem = current_problem();
    }
    agree(comm, problem);
    return std::move(*result);
  }
}

} // namespace dovetail
