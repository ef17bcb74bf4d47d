#include "tests/bench/suites/photographed.h"

#include <fmt/format.h>

#include <cmath>

#include "libhdr/io/bracket.h"

namespace hdr::bench {

Photographed photographed(const BracketPlan& plan) {
  Photographed made;
  made.folder = std::make_unique<support::ScratchFolder>();
  const Path shots = *made.folder / "shots";
  made.truth = photograph(plan, shots);
  made.files = expand_shots({shots});
  made.bracket = read_bracket(made.files);
  return made;
}

double percent_of_ln(double ln) {
  return 100 * std::expm1(ln);
}

std::string text_of(const BracketPlan& plan) {
  return fmt::format("{} {} of {}x{}", plan.evs.size(), plan.format == "jpg" ? "JPEGs" : plan.format + "s",
                     plan.size.width, plan.size.height);
}

}  // namespace hdr::bench
