#include "dovetail/comm/agreement.hpp"

#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/serialization.hpp"

#include <new>

namespace dovetail {
namespace {

Problem lack_of_memory() {
  return {ErrorKind::resource, "", "", "out of memory", "use more ranks or more memory for each"};
}

} // namespace

void agree(const Communicator &comm, const std::optional<Problem> &problem) {
  const int lowest = all_reduce_min(comm, problem ? comm.rank() : comm.size());
  if (lowest == comm.size())
    return;
  Problem shared = problem.value_or(Problem{}); // of interest on the lowest rank alone
  broadcast(comm, shared, lowest);
  throw Error(std::move(shared));
}

Problem current_problem() {
  try {
    throw;
  } catch (const Error &error) {
    return error.problem();
  } catch (const std::bad_alloc &) {
    return lack_of_memory();
  } catch (const std::length_error &) {
    return lack_of_memory();
  } catch (const std::exception &exception) {
    return {ErrorKind::input, "", "", exception.what(), ""};
  } catch (...) {
    return {ErrorKind::input, "", "", "an unknown failure", ""};
  }
}

} // namespace dovetail
