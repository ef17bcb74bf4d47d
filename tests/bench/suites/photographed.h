#pragma once
// Brackets for the suites: photographed once, read from files as any bracket is, truth included.
#include <memory>

#include "libhdr/core/photo.h"
#include "tests/bench/brackets.h"
#include "tests/support/scratch.h"

namespace hdr::bench {

struct Photographed {
  std::unique_ptr<support::ScratchFolder> folder;
  std::vector<Path> files;  ///< in the order of truth.seconds
  Truth truth;
  Bracket bracket;
};

Photographed photographed(const BracketPlan& plan);

/// 100 (e^x - 1): an error of a natural logarithm in percent.
double percent_of_ln(double ln);

/// "1500x1000 x 7".
std::string text_of(const BracketPlan& plan);

}  // namespace hdr::bench
