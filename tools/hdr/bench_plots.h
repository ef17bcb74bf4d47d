#pragma once
#include <string>
#include <vector>

#include "tests/bench/suites/suite.h"

namespace hdr::tools {

/// The plots of one suite's rows, as figures: for each stage time against error, or time against what it scales with.
/// Stages without times, and those of `skips`, have none. A line shows the error that is good enough.
std::string bench_plots(const std::vector<bench::Row>& rows, const bench::Target& target);

}  // namespace hdr::tools
