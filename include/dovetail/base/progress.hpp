/// How long loops tell whoever waits how far they are.
#pragma once

#include <functional>
#include <string_view>

namespace dovetail {

/// Local. Called now and then with the name of the stage and the fraction of it that is done, 0 to 1.
/// May throw to interrupt. An empty function means that nobody listens.
using Progress = std::function<void(std::string_view stage, double fraction)>;

inline void report_progress(const Progress &progress, std::string_view stage, double fraction) {
  if (progress)
    progress(stage, fraction);
}

} // namespace dovetail
