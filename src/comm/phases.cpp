#include "dovetail/comm/phases.hpp"

#include "dovetail/comm/collectives.hpp"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <fstream>
#include <sys/resource.h>
#include <unistd.h>

namespace dovetail {
namespace {

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double cpu_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

} // namespace

std::int64_t peak_rss_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
}

std::int64_t current_rss_bytes() {
  std::ifstream pages("/proc/self/statm");
  std::int64_t total = 0;
  std::int64_t resident = 0;
  pages >> total >> resident;
  return pages ? resident * sysconf(_SC_PAGESIZE) : 0;
}

Phase PhaseLog::reading() const {
  return {"",
          wall_seconds(),
          cpu_seconds(),
          traffic_->bytes_sent,
          traffic_->messages_sent,
          current_rss_bytes(),
          peak_rss_bytes()};
}

void PhaseLog::begin(std::string_view name) {
  end();
  start_ = reading();
  start_.name = name;
  running_ = true;
}

void PhaseLog::end() {
  if (!running_)
    return;
  running_ = false;
  const Phase now = reading();
  auto phase = std::find_if(phases_.begin(), phases_.end(),
                            [&](const Phase &earlier) { return earlier.name == start_.name; });
  if (phase == phases_.end()) {
    phase = phases_.emplace(phases_.end());
    phase->name = start_.name;
  }
  phase->wall_s += now.wall_s - start_.wall_s;
  phase->cpu_s += now.cpu_s - start_.cpu_s;
  phase->bytes_sent += now.bytes_sent - start_.bytes_sent;
  phase->messages_sent += now.messages_sent - start_.messages_sent;
  phase->rss_bytes = now.rss_bytes;
  phase->peak_rss_bytes = now.peak_rss_bytes;
}

std::vector<PhaseSummary> summarise(const Communicator &comm, const PhaseLog &log) {
  std::vector<double> times;
  std::vector<std::int64_t> sums;
  std::vector<std::int64_t> peaks;
  for (const Phase &phase : log.phases()) {
    times.insert(times.end(), {phase.wall_s, phase.cpu_s});
    sums.insert(sums.end(), {phase.bytes_sent, phase.messages_sent});
    peaks.push_back(phase.peak_rss_bytes);
  }
  const auto time_max = all_reduce_max(comm, times);
  const auto time_sum = all_reduce_sum(comm, times);
  const auto sum = all_reduce_sum(comm, sums);
  const auto peak = all_reduce_max(comm, peaks);
  std::vector<PhaseSummary> result;
  for (std::size_t i = 0; i < log.phases().size(); ++i)
    result.push_back({log.phases()[i].name, time_max[2 * i], time_sum[2 * i] / comm.size(),
                      time_max[2 * i + 1], time_sum[2 * i + 1], sum[2 * i], sum[2 * i + 1], peak[i]});
  return result;
}

} // namespace dovetail
