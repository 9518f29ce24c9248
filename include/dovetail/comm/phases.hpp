/// What each phase of a run costs: wall and processor time, traffic, memory.
#pragma once

#include "dovetail/comm/communicator.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dovetail {

/// One rank's cost of one phase.
struct Phase {
  std::string name;
  double wall_s = 0;
  double cpu_s = 0; ///< of the whole process; waiting inside MPI counts as far as MPI spins
  std::int64_t bytes_sent = 0;
  std::int64_t messages_sent = 0;
  std::int64_t rss_bytes = 0;      ///< resident at the end of the phase; 0 if unknown
  std::int64_t peak_rss_bytes = 0; ///< of the process so far
};

/// One phase over all ranks.
struct PhaseSummary {
  std::string name;
  double wall_max_s = 0;
  double wall_mean_s = 0;
  double cpu_max_s = 0;
  double cpu_sum_s = 0;
  std::int64_t bytes_sent = 0;    ///< sum
  std::int64_t messages_sent = 0; ///< sum
  std::int64_t peak_rss_max_bytes = 0;
};

/// Local. Measures phases one after the other. A phase of a name that was there before adds to it.
class PhaseLog {
public:
  explicit PhaseLog(const Communicator &comm) : traffic_(&comm.traffic()) {}

  /// Ends the running phase, if any, and begins another.
  void begin(std::string_view name);
  void end();

  /// Runs `work` as a phase.
  template <class Work> decltype(auto) measure(std::string_view name, Work &&work) {
    begin(name);
    struct End {
      PhaseLog &log;
      ~End() { log.end(); }
    } const at_end{*this};
    return std::forward<Work>(work)();
  }

  const std::vector<Phase> &phases() const { return phases_; }

private:
  Phase reading() const;

  const Traffic *traffic_; ///< lives as long as the communicator or any that was split from it
  std::vector<Phase> phases_;
  Phase start_;
  bool running_ = false;
};

/// Collective. All ranks must have logged the same names in the same order.
std::vector<PhaseSummary> summarise(const Communicator &comm, const PhaseLog &log);

/// Local. The largest resident set of this process so far, and the present one (0 where the system does not
/// tell).
std::int64_t peak_rss_bytes();
std::int64_t current_rss_bytes();

} // namespace dovetail
