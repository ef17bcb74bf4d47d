// Exposures that a device has, and that lamps allow.
#include <algorithm>
#include <cmath>

#include "capture/plan.h"

namespace hdr {
namespace {

/// Rounding of what is a multiple already.
constexpr double kSlack = 1e-9;

double step_down(const Range& range, double value) {
  if (value >= range.max) return range.snap(range.max);
  if (!(range.step > 0)) return std::max(value, range.min);
  return std::max(range.min, range.min + range.step * std::floor((value - range.min) / range.step * (1 + kSlack)));
}

double step_up(const Range& range, double value) {
  if (value <= range.min) return range.min;
  if (!(range.step > 0)) return std::min(value, range.max);
  return range.snap(range.min + range.step * std::ceil((value - range.min) / range.step * (1 - kSlack)));
}

/// The device's time nearest to a multiple of the flicker's period: one that is a step off leaves little flicker.
double whole_periods(const Range& range, double periods, double period) {
  return range.snap(periods * period);
}

double longest_steady(const Range& range, double period) {
  if (!(period > 0) || range.max < period) return range.snap(range.max);
  return whole_periods(range, std::floor(range.max / period * (1 + kSlack)), period);
}

double period_of(std::optional<double> mains_hz) {
  return mains_hz && *mains_hz > 0 ? 0.5 / *mains_hz : 0;
}

}  // namespace

ExposureSetting setting_at_most(double total, const Capabilities& limits, std::optional<double> mains_hz) {
  const double period = period_of(mains_hz);
  const double longest = longest_steady(limits.seconds, period);
  ExposureSetting setting{total / limits.gain.min, limits.gain.min};
  if (setting.seconds > longest * (1 + kSlack)) return {longest, step_down(limits.gain, total / longest)};
  if (period > 0 && setting.seconds >= period * (1 - kSlack)) {
    setting.seconds = whole_periods(limits.seconds, std::floor(setting.seconds / period * (1 + kSlack)), period);
  } else {
    setting.seconds = step_down(limits.seconds, setting.seconds);
  }
  return setting;
}

ExposureSetting setting_at_least(double total, const Capabilities& limits, std::optional<double> mains_hz) {
  const double period = period_of(mains_hz);
  const double longest = longest_steady(limits.seconds, period);
  ExposureSetting setting{total / limits.gain.min, limits.gain.min};
  if (setting.seconds > longest * (1 + kSlack)) return {longest, step_up(limits.gain, total / longest)};
  if (period > 0 && setting.seconds > period * (1 - kSlack)) {
    setting.seconds = whole_periods(limits.seconds, std::ceil(setting.seconds / period * (1 - kSlack)), period);
  } else {
    setting.seconds = step_up(limits.seconds, setting.seconds);
  }
  return setting;
}

ExposureSetting setting_near(double total, const Capabilities& limits, std::optional<double> mains_hz) {
  const ExposureSetting below = setting_at_most(total, limits, mains_hz),
                        above = setting_at_least(total, limits, mains_hz);
  return std::abs(std::log(below.total() / total)) <= std::abs(std::log(above.total() / total)) ? below : above;
}

}  // namespace hdr
