/// Making one rank's problem everybody's before the next collective, so that nobody waits for ever.
#pragma once

#include "dovetail/base/error.hpp"
#include "dovetail/comm/communicator.hpp"

#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

namespace dovetail {

/// Collective. If any rank has a problem, every rank throws the same Error: that of the lowest such rank.
void agree(const Communicator &comm, const std::optional<Problem> &problem);

/// The problem that the exception being handled describes: an Error as it is, std::bad_alloc and
/// std::length_error as a lack of memory, any other std::exception by its text. For use inside catch (...).
Problem current_problem();

/// The same, where a lack of memory is told with the rank that lacks it and what for: `purpose` makes the
/// words, such as "the paths of its slabs", and is only asked then.
template <class Purpose> Problem current_problem(const Communicator &comm, Purpose &&purpose) {
  const auto told = [&](Problem problem) {
    problem.subject = "rank " + std::to_string(comm.top_rank());
    problem.what += " for " + std::string(purpose());
    return problem;
  };
  try {
    throw;
  } catch (const std::bad_alloc &) {
    return told(current_problem());
  } catch (const std::length_error &) {
    return told(current_problem());
  } catch (...) {
    return current_problem();
  }
}

/// Collective. Runs `work`, which must itself be Local, and agrees on how it ended. Whatever may need more
/// memory than there is belongs in here: a rank that runs out of it elsewhere leaves the others waiting.
template <class Purpose, class Work>
auto collectively(const Communicator &comm, Purpose &&purpose, Work &&work) {
  std::optional<Problem> problem;
  if constexpr (std::is_void_v<std::invoke_result_t<Work>>) {
    try {
      std::forward<Work>(work)();
    } catch (...) {
      problem = current_problem(comm, purpose);
    }
    agree(comm, problem);
  } else {
    std::optional<std::invoke_result_t<Work>> result;
    try {
      result.emplace(std::forward<Work>(work)());
    } catch (...) {
      problem = current_problem(comm, purpose);
    }
    agree(comm, problem);
    return std::move(*result);
  }
}
template <class Work> auto collectively(const Communicator &comm, Work &&work) {
  return collectively(
      comm, [] { return "its share"; }, std::forward<Work>(work));
}

} // namespace dovetail
