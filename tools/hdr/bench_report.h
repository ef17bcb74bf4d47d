#pragma once
#include <string>
#include <vector>

#include "tests/bench/bench.h"
#include "tests/bench/suites/suite.h"
#include "tools/hdr/verb.h"

namespace hdr::tools {

/// The page of `hdr bench -o`: which setting to use, then each suite with its plots of time against error, its scaling
/// and its rows, then the rivals that were not there, the seconds of the suites (the stages of `run`) and the machine.
std::string bench_report(const bench::Bench& all, const std::vector<const bench::Suite*>& suites, const Run& run);

}  // namespace hdr::tools
