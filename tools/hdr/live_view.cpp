#include "tools/hdr/live_view.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "libhdr/io/exposure_list.h"

namespace hdr::tools {
namespace {

/// Samples of all colours in equal steps of the code.
std::vector<double> steps_of(const Appearance& appearance, int bars) {
  std::vector<double> steps(static_cast<std::size_t>(bars), 0.0);
  const double black = appearance.usable.black, range = appearance.usable.white - black;
  for (const CodeHistogram& colour : appearance.colours) {
    for (std::size_t code = 0; code < colour.counts.size(); ++code) {
      const double share = range > 0 ? (static_cast<double>(code) - black) / range : 0;
      const auto step = static_cast<std::size_t>(std::clamp(share * bars, 0.0, bars - 1.0));
      steps[step] += colour.counts[code];
    }
  }
  return steps;
}

}  // namespace

std::string histogram_line(const Appearance& appearance, const ExposureSetting& setting, int bars) {
  static constexpr const char* kBars[] = {" ", "▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  constexpr double kHighest = 8;
  const std::vector<double> steps = steps_of(appearance, bars);
  const double most = std::max(1.0, *std::max_element(steps.begin(), steps.end()));
  std::string line;
  for (const double samples : steps) {
    line += kBars[static_cast<std::size_t>(std::ceil(kHighest * std::sqrt(samples / most)))];
  }
  line += fmt::format("  clipped {:.2g} %  dark {:.2g} %  {}", 100 * appearance.clipped(), 100 * appearance.dark(),
                      text_from_seconds(setting.seconds));
  if (setting.gain != 1) line += fmt::format(" x {:.3g}", setting.gain);
  return line;
}

LiveView::LiveView(bool silent) : on_(!silent && isatty(STDERR_FILENO) == 1) {}

void LiveView::clear() {
  if (drawn_) fmt::print(stderr, "\r\033[K");
  drawn_ = false;
}

void LiveView::show(const Frame& frame) {
  if (!on_) return;
  const ExposureSetting setting = frame.reported.value_or(frame.requested);
  fmt::print(stderr, "\r\033[K{}", histogram_line(appearance_of(frame), setting));
  std::fflush(stderr);
  drawn_ = true;
}

}  // namespace hdr::tools
