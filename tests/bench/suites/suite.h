#pragma once
// The suites of `hdr bench`, a file each.
#include <vector>

#include "tests/bench/bench.h"

namespace hdr::bench {

/// What "good enough" means where advice is given: the cheapest setting within it.
struct Target {
  double error = 5;
  const char* unit = "%";
};

struct Suite {
  const char* name;
  const char* sentence;  ///< what turns, and what the error is
  void (*run)(Bench&);
  Target target{};
};

const std::vector<Suite>& suites();
const Suite* find_suite(const std::string& name);

void calibrate_suite(Bench& bench);
void merge_suite(Bench& bench);
void align_suite(Bench& bench);
void unwrap_suite(Bench& bench);
void sh_suite(Bench& bench);
void lights_suite(Bench& bench);
void render_suite(Bench& bench);
void capture_plan_suite(Bench& bench);
void files_suite(Bench& bench);
void filter_suite(Bench& bench);
void lecture_suite(Bench& bench);
void skips_suite(Bench& bench);
void numerics_suite(Bench& bench);

}  // namespace hdr::bench
