// What people are told while they wait.
#include "cli/progress.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>

namespace dovetail::cli {
namespace {

/// What is shown within the next second and a bit.
std::string shown_soon() {
  ::testing::internal::CaptureStderr();
  std::this_thread::sleep_for(std::chrono::milliseconds(1200));
  return ::testing::internal::GetCapturedStderr();
}

TEST(Progress, PromisesAnEndWhileAStageTells) {
  ProgressMeter meter(ProgressStyle::live, {{"read", 1}, {"check", 3}});
  meter.update("read", 0.25);
  EXPECT_TRUE(shown_soon().ends_with(" left\033[K"));
}

TEST(Progress, PromisesNoEndOnceAllOfAStageIsTold) {
  ProgressMeter meter(ProgressStyle::live, {{"read", 1}, {"check", 3}});
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  meter.begin("check");
  meter.update("check", 1); // and other ranks take longer
  const std::string shown = shown_soon();
  EXPECT_NE(shown.find("dovetail: check, "), std::string::npos) << shown;
  EXPECT_EQ(shown.find("left"), std::string::npos) << shown;
  EXPECT_EQ(shown.find("100 %"), std::string::npos) << shown;
}

TEST(Progress, QuietIsQuiet) {
  ProgressMeter meter(ProgressStyle::silent, {{"read", 1}});
  meter.update("read", 0.5);
  EXPECT_EQ(shown_soon(), "");
}

} // namespace
} // namespace dovetail::cli
