/// How long loops tell whoever waits how far they are.
#pragma once

#include <algorithm>
#include <functional>
#include <string_view>
#include <utility>

namespace dovetail {

/// Local. Called now and then with the name of the stage and the fraction of it that is done, 0 to 1.
/// May throw to interrupt. An empty function means that nobody listens.
using Progress = std::function<void(std::string_view stage, double fraction)>;

inline void report_progress(const Progress &progress, std::string_view stage, double fraction) {
  if (progress)
    progress(stage, fraction);
}

/// For whoever does several things in one stage: what is told of one of them, 0 to 1, is `from` to `to` of
/// the stage.
inline Progress part_of_stage(const Progress &progress, double from, double to) {
  if (!progress)
    return {};
  return [progress, from, to](std::string_view stage, double fraction) {
    progress(stage, from + (to - from) * fraction);
  };
}

/// Counts what is done of a stage, in any unit, and tells it each time. Local.
class ProgressCount {
public:
  /// `whole`: all there is to do, at least about.
  ProgressCount(Progress progress, std::string_view stage, double whole)
      : progress_(std::move(progress)), stage_(stage), whole_(whole) {}
  void add(double amount) {
    done_ += amount;
    if (amount > 0)
      report_progress(progress_, stage_, std::min(1.0, done_ / whole_));
  }

private:
  Progress progress_;
  std::string_view stage_; ///< a literal
  double whole_;
  double done_ = 0;
};

} // namespace dovetail
