/// Signs of life on standard error while a long run works.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace dovetail::cli {

/// A stage of a run and its usual share of the time, on any scale.
struct Stage {
  std::string name;
  double weight;
};

enum class ProgressStyle {
  silent,
  lines, ///< a line every few seconds, for logs and pipes
  live,  ///< one line that is written over
};

/// Tells from a thread of its own, which never calls MPI, which stage is under way, how much of the run is
/// done, and how long the rest will take: the stage under way at its own speed, and those to come if they
/// share the time with the others as they usually do; the percent grows by what is measured. It promises
/// nothing before it has measured something, nor when a stage takes longer than usual without telling how far
/// it is, nor once a stage has told all. Nothing is printed in the first seconds: short runs stay silent.
/// Local. One at a time in a process.
class ProgressMeter {
public:
  ProgressMeter(ProgressStyle style, std::vector<Stage> stages);
  ProgressMeter(const ProgressMeter &) = delete;
  ProgressMeter &operator=(const ProgressMeter &) = delete;
  ~ProgressMeter();

  /// The stage `name` begins, and all before it in the list have ended. A name that is not in the list counts
  /// as part of the stage under way.
  void begin(std::string_view name);
  /// So much of the stage `name` is done, 0 to 1; begins it if it is not under way. A stage that never tells
  /// is judged by its usual share.
  void update(std::string_view name, double fraction);
  /// No more lines; a live line is wiped. May be called more than once.
  void finish();

private:
  using Clock = std::chrono::steady_clock;
  void begin_locked(std::string_view name);
  friend std::string silence_progress();
  void run();
  void wipe_locked();
  bool is_measured(Clock::time_point now) const;
  std::optional<double> stage_seconds(Clock::time_point now, double weight_before) const;
  std::string line(Clock::time_point now);

  const ProgressStyle style_;
  const std::vector<Stage> stages_;
  const Clock::time_point start_ = Clock::now();

  std::mutex mutex_;
  std::condition_variable wake_;
  std::size_t current_ = 0;
  Clock::time_point stage_start_ = start_;
  double told_ = 0;                    ///< fraction of the stage, when last told
  double told_step_ = 0;               ///< by how much it had grown
  Clock::time_point told_at_ = start_; ///< when
  double shown_fraction_ = 0;          ///< of the run, which never goes back
  bool finished_ = false;
  bool shown_ = false; ///< a live line stands there
  std::thread thread_;
};

/// For whoever ends the run from another thread: the stage under way, or nothing without a meter. No meter
/// shows anything from then on, and none begins or ends: whoever tries is never returned to. Local.
std::string silence_progress();

} // namespace dovetail::cli
