#include "tests/bench/advice.h"

#include <fmt/format.h>

#include <cmath>

namespace hdr::bench {
namespace {

bool is_effort(const Row& row) {
  return row.knob != "threads" && row.knob != "megapixels" && row.timed() && std::isfinite(row.error);
}

std::string words_of(const Row& row) {
  const std::string what =
      row.setting.empty() ? row.subject + " with " + text_of_value(row) + " " + row.knob : "`" + row.setting + "`";
  const std::string time = row.time_name.empty() ? short_seconds(row.cpu_seconds) + " CPU"
                                                 : short_number(row.wall_seconds) + " " + row.time_name;
  return fmt::format("{} ({} {}, {})", what, short_number(row.error), row.error_unit, time);
}

}  // namespace

std::string advice_of(const Suite& suite, const std::vector<Row>& rows) {
  const Row *cheapest = nullptr, *rival = nullptr, *closest = nullptr;
  for (const Row& row : rows) {
    if (row.suite != suite.name || !is_effort(row) || row.error_unit != suite.target.unit) continue;
    const bool within = row.error <= suite.target.error;
    if (row.ours()) {
      if (row.setting.empty()) continue;  // nobody could ask for it
      if (within && (!cheapest || row.time() < cheapest->time())) cheapest = &row;
      if (!closest || row.error < closest->error) closest = &row;
    } else if (within && row.subject != "hdr reference" && (!rival || row.time() < rival->time())) {
      rival = &row;
    }
  }
  if (!closest) return {};
  const std::string goal = fmt::format("{} {}", short_number(suite.target.error), suite.target.unit);
  std::string text = cheapest ? fmt::format("For {}: {}", goal, words_of(*cheapest))
                              : fmt::format("{} is not reached; closest: {}", goal, words_of(*closest));
  if (rival) text += "; " + words_of(*rival);
  return text + ".";
}

}  // namespace hdr::bench
