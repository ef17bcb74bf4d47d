#include "tools/hdr/report/ticks.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"
#include "tools/hdr/report/html.h"

namespace hdr::report {
namespace {

/// 10 to the power k: as a number while it is short, else 10 with its exponent raised.
std::string power_text(int k) {
  if (k >= -3 && k <= 3) return number(std::pow(10.0, k), 1);
  static constexpr const char* kRaised[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = k < 0 ? "10⁻" : "10";
  for (const char digit : std::to_string(std::abs(k))) text += kRaised[digit - '0'];
  return text;
}

}  // namespace

std::vector<Tick> linear_ticks(double low, double high, int count) {
  HDR_ASSERT(std::isfinite(low) && std::isfinite(high) && low < high && count > 0);
  const double rough = (high - low) / count;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  const double step = power * (rough <= 1.5 * power ? 1 : rough <= 3.5 * power ? 2 : rough <= 7.5 * power ? 5 : 10);
  const double slack = 1e-9 * (high - low);
  std::vector<Tick> ticks;
  for (double k = std::ceil((low - slack) / step); k * step <= high + slack; k += 1) {
    const double value = k * step;
    const int digits = std::max(3, static_cast<int>(std::ceil(std::log10(std::abs(value) / step + 1))) + 1);
    ticks.push_back({value, number(k == 0 ? 0 : value, digits)});
  }
  return ticks;
}

std::vector<Tick> log_ticks(double low, double high, int count) {
  HDR_ASSERT(low > 0 && std::isfinite(high) && low < high && count > 0);
  const double decades = std::log10(high / low);
  const int first = static_cast<int>(std::floor(std::log10(low))), last = static_cast<int>(std::ceil(std::log10(high)));
  const int stride = std::max(1, static_cast<int>(std::ceil(decades / count)));
  std::vector<Tick> ticks;
  for (int k = first; k <= last; ++k) {
    const double power = std::pow(10.0, k);
    for (int m = 1; m <= 9; ++m) {
      const double value = m * power;
      if (value < low * (1 - 1e-9) || value > high * (1 + 1e-9)) continue;
      const bool labelled = m == 1 ? k % stride == 0 : decades < 0.6 || (decades < 2.5 && (m == 2 || m == 5));
      if (m > 1 && stride > 1) continue;
      const std::string between = k < -3 || k > 3 ? std::to_string(m) + "·" + power_text(k) : number(value, 1);
      ticks.push_back({value, !labelled ? "" : m == 1 ? power_text(k) : between});
    }
  }
  return ticks;
}

}  // namespace hdr::report
