/// Errors that a user can cause and mend, and those that cheap checks find in finished results. Other bugs
/// are assertions, and MPI's own failures stay fatal.
#pragma once

#include <stdexcept>
#include <string>

namespace dovetail {

enum class ErrorKind : int {
  usage,    ///< the request makes no sense
  input,    ///< an input is missing, malformed, or not what was promised
  output,   ///< an output cannot be written
  resource, ///< memory, disk or index range does not suffice
  fault,    ///< a check of its own results failed: a bug of dovetail, caught before it became a result
};

/// What went wrong, where, and what to do next. All text is for people.
struct Problem {
  ErrorKind kind = ErrorKind::input;
  std::string subject; ///< file or option, as the user named it
  std::string place;   ///< byte, record, line or dataset inside it; may be empty
  std::string what;    ///< the fault, one clause
  std::string remedy;  ///< what to do next, one clause; may be empty
};

/// Thrown alike on all ranks of a communicator once `agree` has made a local problem everyone's.
class Error : public std::runtime_error {
public:
  explicit Error(Problem problem);
  const Problem &problem() const noexcept { return problem_; }
  ErrorKind kind() const noexcept { return problem_.kind; }

private:
  Problem problem_;
};

} // namespace dovetail
