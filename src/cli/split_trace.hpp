/// What the kernel split-path did at each level, for people and for programs.
#pragma once

#include "report.hpp"

#include "dovetail/distributed/kernel.hpp"

namespace dovetail::cli {

/// As on the command line.
const char *kernel_name(Kernel kernel);

/// {"levels": [{...}, ...], "times": [{"name", "sum_s", "max_s"}, ...]}
Report split_trace_as_json(const SplitTraceSummary &trace);

/// A table of the levels and of the time in each part of the work.
void print_split_trace(const SplitTraceSummary &trace, GlobalIndex sites);

} // namespace dovetail::cli
