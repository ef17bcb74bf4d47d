#pragma once
#include <string>
#include <vector>

#include "tests/bench/bench.h"
#include "tests/bench/suites/suite.h"

namespace hdr::tools {

/// The page of `hdr bench -o`: which setting to use, then each suite with its plots of time against error, its scaling
/// and its rows, then the machine and the rivals that were not there.
std::string bench_report(const bench::Bench& all, const std::vector<const bench::Suite*>& suites);

}  // namespace hdr::tools
