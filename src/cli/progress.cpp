#include "progress.hpp"

#include "text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace dovetail::cli {
namespace {
constexpr auto line_interval = std::chrono::seconds(5);
constexpr auto live_interval = std::chrono::milliseconds(500);

double seconds_between(std::chrono::steady_clock::time_point from, std::chrono::steady_clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

/// Not 100: that is when nothing more is said.
int percent(double fraction) { return std::min(99, static_cast<int>(100 * fraction)); }

// Who ends a run because of a signal stands outside of it, and the signal is the process's, so this is too.
std::mutex meter_mutex;
ProgressMeter *meter_in_use = nullptr;

} // namespace

ProgressMeter::ProgressMeter(ProgressStyle style, std::vector<Stage> stages)
    : style_(style), stages_(std::move(stages)) {
  {
    const std::lock_guard lock(meter_mutex);
    meter_in_use = this;
  }
  if (style_ != ProgressStyle::silent && !stages_.empty())
    thread_ = std::thread([this] { run(); });
}

ProgressMeter::~ProgressMeter() {
  finish();
  const std::lock_guard lock(meter_mutex);
  meter_in_use = nullptr;
}

void ProgressMeter::begin(std::string_view name) {
  const std::lock_guard lock(mutex_);
  begin_locked(name);
}

void ProgressMeter::begin_locked(std::string_view name) {
  const auto stage =
      std::find_if(stages_.begin(), stages_.end(), [&](const Stage &s) { return s.name == name; });
  if (stage == stages_.end())
    return;
  current_ = static_cast<std::size_t>(stage - stages_.begin());
  stage_start_ = Clock::now();
  told_ = 0;
}

void ProgressMeter::update(std::string_view name, double fraction) {
  const std::lock_guard lock(mutex_);
  if (stages_.empty())
    return;
  if (stages_[current_].name != name)
    begin_locked(name);
  if (stages_[current_].name != name || fraction <= told_)
    return;
  told_step_ = std::min(fraction, 1.0) - told_;
  told_ = std::min(fraction, 1.0);
  told_at_ = Clock::now();
}

void ProgressMeter::finish() {
  {
    const std::lock_guard lock(mutex_);
    finished_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable())
    thread_.join();
}

void ProgressMeter::run() {
  const bool live = style_ == ProgressStyle::live;
  const auto interval = live ? Clock::duration(live_interval) : Clock::duration(line_interval);
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, interval, [this] { return finished_; })) {
    const std::string text = line(Clock::now());
    if (live)
      fmt::print(stderr, "\r{}\033[K", text);
    else
      fmt::print(stderr, "{}\n", text);
    std::fflush(stderr);
    shown_ = live;
  }
  wipe_locked();
}

void ProgressMeter::wipe_locked() {
  if (!std::exchange(shown_, false))
    return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
}

/// Whether the stage under way has told enough to be judged by it: its first moments may be fast ones, say
/// into a cache, and a percent that has been shown stays.
bool ProgressMeter::is_measured(Clock::time_point now) const {
  constexpr double too_young = 0.1;
  return told_ > 0 && seconds_between(stage_start_, now) >= too_young * seconds_between(start_, stage_start_);
}

/// How long the stage under way takes from its beginning to its end, as far as anybody can know.
std::optional<double> ProgressMeter::stage_seconds(Clock::time_point now, double weight_before) const {
  const double in_stage = seconds_between(stage_start_, now);
  if (told_ >= 1) // all that tells is done, here; the rest of it, or other ranks, are under way
    return std::nullopt;
  if (is_measured(now)) {
    // It may tell rarely, say of one slab after another: go on at its speed, but not beyond what comes next.
    const double until_told = seconds_between(stage_start_, told_at_);
    const double reached = until_told > 0 ? told_ * in_stage / until_told : told_;
    return in_stage / std::min({reached, told_ + told_step_, 1.0});
  }
  if (weight_before <= 0)
    return std::nullopt;
  const double usual = stages_[current_].weight * seconds_between(start_, stage_start_) / weight_before;
  return in_stage < usual ? std::optional(usual) : std::nullopt;
}

std::string ProgressMeter::line(Clock::time_point now) {
  double before = 0;
  double after = 0;
  for (std::size_t s = 0; s < stages_.size(); ++s)
    (s < current_ ? before : after) += s != current_ ? stages_[s].weight : 0;
  const double own = stages_[current_].weight;
  const double elapsed = seconds_between(start_, now);
  const std::string text =
      fmt::format("dovetail: {}, {} gone", stages_[current_].name, rough_duration_text(elapsed));
  const std::optional<double> stage = stage_seconds(now, before);
  if (!stage) {
    shown_fraction_ = std::max(shown_fraction_, before / (before + own + after));
    return shown_fraction_ > 0 ? text + fmt::format(", over {} % done", percent(shown_fraction_)) : text;
  }
  // The stages to come are as much slower or faster than usual as those that are known.
  const double known = seconds_between(start_, stage_start_) + *stage;
  const double whole = known * (before + own + after) / (before + own);
  // Who finds that the rest takes longer than thought has not done less for that; who has measured nothing of
  // a stage claims nothing of it.
  shown_fraction_ =
      std::max(shown_fraction_, is_measured(now) ? elapsed / whole : before / (before + own + after));
  return text + fmt::format(", about {} % done, {} left", percent(shown_fraction_),
                            rough_duration_text(whole - elapsed));
}

std::string silence_progress() {
  std::unique_lock meters(meter_mutex);
  meters.release();
  if (meter_in_use == nullptr)
    return "";
  std::unique_lock lock(meter_in_use->mutex_);
  meter_in_use->wipe_locked();
  lock.release();
  return meter_in_use->stages_.empty() ? "" : meter_in_use->stages_[meter_in_use->current_].name;
}

} // namespace dovetail::cli
