#include "progress.hpp"

#include "text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace dovetail::cli {
namespace {
constexpr auto line_interval = std::chrono::seconds(5);
constexpr auto live_interval = std::chrono::milliseconds(500);

/// How much of a stage is done if only its usual length is known. A stage that takes longer than usual creeps
/// towards its end and never passes it.
double guessed_fraction(double gone, double expected) {
  if (gone < 0.9 * expected)
    return gone / expected;
  return 1 - 0.09 * expected / gone;
}

} // namespace

ProgressMeter::ProgressMeter(ProgressStyle style, std::vector<Stage> stages)
    : style_(style), stages_(std::move(stages)) {
  if (style_ != ProgressStyle::silent && !stages_.empty())
    thread_ = std::thread([this] { run(); });
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
  told_fraction_ = 0;
}

void ProgressMeter::update(std::string_view name, double fraction) {
  const std::lock_guard lock(mutex_);
  if (stages_.empty())
    return;
  if (stages_[current_].name != name)
    begin_locked(name);
  if (stages_[current_].name == name)
    told_fraction_ = std::clamp(fraction, 0.0, 1.0);
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
  bool shown = false;
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, interval, [this] { return finished_; })) {
    const std::string text = line(Clock::now());
    if (live)
      fmt::print(stderr, "\r{}\033[K", text);
    else
      fmt::print(stderr, "{}\n", text);
    std::fflush(stderr);
    shown = true;
  }
  if (live && shown) {
    std::fputs("\r\033[K", stderr);
    std::fflush(stderr);
  }
}

std::string ProgressMeter::line(Clock::time_point now) const {
  double total = 0;
  double before = 0;
  for (std::size_t s = 0; s < stages_.size(); ++s) {
    total += stages_[s].weight;
    before += s < current_ ? stages_[s].weight : 0;
  }
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const double in_stage = std::chrono::duration<double>(now - stage_start_).count();
  const double before_stage = elapsed - in_stage;
  std::string text =
      fmt::format("dovetail: {}, {} gone", stages_[current_].name, rough_duration_text(elapsed));

  // What the stage tells may be coarse, a slab at a time; what is usual fills the gaps.
  double fraction = told_fraction_;
  if (before > 0 && before_stage > 0)
    fraction =
        std::max(fraction, guessed_fraction(in_stage, stages_[current_].weight * before_stage / before));
  const double done = (before + stages_[current_].weight * fraction) / total;
  // As long as nothing has been measured, nothing is promised.
  if (done <= 0)
    return text;
  return text + fmt::format(", about {:.0f} % done, {} left", 100 * done,
                            rough_duration_text(elapsed * (1 - done) / done));
}

} // namespace dovetail::cli
