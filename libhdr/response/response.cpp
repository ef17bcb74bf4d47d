#include "libhdr/response/response.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"

namespace hdr {
namespace {

/// Exposure at the lower end of code 1's cell, "code 1/2": code 0's cell starts at no light and g(0) is its middle, so
/// it ends at twice exp(g(0)). A curve that rises less than that between codes 0 and 1 ends the cell half-way.
double end_of_code_zero(double exposure0, double exposure_of_next_sample, double next_code) {
  const double straight = exposure0 + (exposure_of_next_sample - exposure0) * 0.5 / next_code;
  return std::min(2 * exposure0, straight);
}

}  // namespace

int response_levels(int bits) {
  return bits <= 8 ? 1 << bits : 4096;
}

double Response::code_from_level(int level) const {
  return bits <= 8 ? level : std::ldexp(static_cast<double>(level), bits - 12);
}

double Response::exposure(int channel, double code) const {
  const std::vector<double>& curve = g[static_cast<std::size_t>(channel)];
  HDR_ASSERT(curve.size() >= 2);
  const double step = code_from_level(1);
  const int below = std::clamp(static_cast<int>(code / step), 0, levels() - 2);
  const double low = std::exp(curve[static_cast<std::size_t>(below)]);
  const double high = std::exp(curve[static_cast<std::size_t>(below) + 1]);
  if (below == 0 && code < step) {
    // The first interval starts at the end of code 0's cell; the cell itself is represented by its middle.
    if (code <= 0) return low;
    const double end = end_of_code_zero(low, high, step);
    if (code <= 0.5) return std::max(low, end * 2 * code);
    return step <= 0.5 ? high : end + (high - end) * (code - 0.5) / (step - 0.5);
  }
  return low + (high - low) * (code / step - below);
}

double Response::ln_exposure(int channel, double code) const {
  return std::log(exposure(channel, code));
}

int Response::black_code(int channel) const {
  const std::vector<double>& curve = g[static_cast<std::size_t>(channel)];
  int level = 0;
  while (level + 1 < levels() && curve[static_cast<std::size_t>(level) + 1] <= curve[0]) ++level;
  return static_cast<int>(code_from_level(level));
}

std::vector<float> Response::exposure_table(int channel) const {
  std::vector<float> table(std::size_t{1} << bits);
  for (std::size_t code = 0; code < table.size(); ++code) {
    table[code] = static_cast<float>(exposure(channel, static_cast<double>(code)));
  }
  return table;
}

std::vector<double> Response::exposure_thresholds(int channel) const {
  std::vector<double> thresholds((std::size_t{1} << bits) - 1);
  double last = 0;
  for (std::size_t code = 0; code < thresholds.size(); ++code) {
    last = std::max(last, exposure(channel, static_cast<double>(code) + 0.5));
    thresholds[code] = last;
  }
  return thresholds;
}

}  // namespace hdr
