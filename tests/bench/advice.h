#pragma once
#include <string>
#include <vector>

#include "tests/bench/row.h"
#include "tests/bench/suites/suite.h"

namespace hdr::bench {

/// What a suite's rows say to somebody who wants an error within its target: the cheapest of our settings that is, and
/// what the cheapest rival within it costs; or how close it comes.
std::string advice_of(const Suite& suite, const std::vector<Row>& rows);

}  // namespace hdr::bench
