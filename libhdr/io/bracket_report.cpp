#include "libhdr/io/bracket_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "libhdr/core/color.h"
#include "libhdr/core/rows.h"
#include "libhdr/io/exposure_list.h"
#include "libhdr/io/internal/dng_file.h"

namespace hdr {
namespace {

constexpr double kClippedCode = 0.99, kDarkCode = 0.02;           // of the full scale
constexpr double kShadowShare = 0.001, kHighlightShare = 0.0001;  // of the pixels
constexpr double kWidestStep = 4;                                 // EV

/// Of the brightest channel of each pixel, in 1024 steps of the full scale.
struct Tally {
  static constexpr std::size_t kBins = 1024;
  std::array<std::int64_t, kBins> brightest{};
  std::int64_t pixels = 0, black = 0;  ///< black: code 0, of which nothing more is known

  void add(double code) {
    if (code == 0) ++black;
    ++brightest[std::min(kBins - 1, static_cast<std::size_t>(code * kBins))];
    ++pixels;
  }
  /// Share of the pixels for which `is` holds at the bin's lower end.
  template <class Is>
  double share(const Is& is) const {
    std::int64_t count = 0;
    for (std::size_t k = 0; k < kBins; ++k) {
      if (is(static_cast<double>(k) / kBins)) count += brightest[k];
    }
    return pixels > 0 ? static_cast<double>(count) / static_cast<double>(pixels) : 0;
  }
};

Tally tally_of(const Photo& shot) {
  Tally tally;
  const auto rows = rows_of(shot);
  const double per_code = 1.0 / shot.max_code();
  for (int y = 0; y < shot.height(); ++y) {
    std::visit(
        [&](const auto& view) {
          for (int x = 0; x < view.width(); ++x) {
            const auto* p = view.pixel(x, 0);
            tally.add(per_code * std::max({p[0], p[1], p[2]}));
          }
        },
        rows->rows(y, y + 1));
  }
  return tally;
}

/// Dial times are rounded to 0.3, 1/6, 1/13, 1/60 ... of a series that doubles every third step.
bool is_nominal(double seconds) {
  static constexpr std::array kDial = {1.0,    1.25,   5 / 3.0, 10 / 3.0, 1.3,    1.6,    2.0,    2.5,    3.2,
                                       4.0,    5.0,    6.0,     8.0,      10.0,   13.0,   15.0,   20.0,   25.0,
                                       30.0,   40.0,   50.0,    60.0,     80.0,   100.0,  125.0,  160.0,  200.0,
                                       250.0,  320.0,  400.0,   500.0,    640.0,  800.0,  1000.0, 1250.0, 1600.0,
                                       2000.0, 2500.0, 3200.0,  4000.0,   5000.0, 6400.0, 8000.0};
  return std::any_of(kDial.begin(), kDial.end(), [&](double n) {
    constexpr double kSame = 2e-3;
    return std::abs(seconds * n - 1) < kSame || std::abs(seconds / n - 1) < kSame;
  });
}

/// A time on the dial for a shot `ev` brighter.
std::string time_text(const Exposure& exposure, double ev) {
  return exposure.seconds ? " (" + text_from_seconds(*exposure.seconds * std::exp2(ev)) + ")" : "";
}

double median_step(const BracketReport& report) {
  std::vector<double> steps;
  for (const ShotReport& shot : report.shots) {
    if (shot.step && *shot.step > 0.1) steps.push_back(*shot.step);
  }
  if (steps.empty()) return 2;
  std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2), steps.end());
  return std::clamp(std::round(steps[steps.size() / 2]), 1.0, 3.0);
}

/// The fewest stops that lift all but a few pixels of the longest shot out of the dark; nullopt: more than it can tell.
std::optional<int> stops_to_shadows(const Tally& longest, bool linear) {
  const auto light = [&](double code) { return linear ? code : linear_from_srgb(code); };
  constexpr int kMost = 6;
  if (static_cast<double>(longest.black) > kShadowShare * static_cast<double>(longest.pixels)) return std::nullopt;
  for (int stops = 1; stops <= kMost; ++stops) {
    const double brighter = std::exp2(stops);
    // Half a bin up: codes of the lowest bin are not all zero.
    const double still_dark = longest.share([&](double code) {
      return light(code + 0.5 / Tally::kBins) * brighter < light(kDarkCode) && code < kDarkCode;
    });
    if (still_dark < kShadowShare) return stops;
  }
  return std::nullopt;
}

void say_what_is_missing(BracketReport& report, const Tally& longest, bool linear) {
  const ShotReport &first = report.shots.front(), &last = report.shots.back();
  const double step = median_step(report);
  if (last.dark > kShadowShare) {
    const auto stops = stops_to_shadows(longest, linear);
    report.missing.push_back(
        stops ? fmt::format("one more shot at +{} EV{} would cover the shadows: {:.2g} % of the longest shot are dark",
                            *stops, time_text(last.exposure, *stops), 100 * last.dark)
              : fmt::format(
                    "more shots from +{:.0f} EV{} on would reach the shadows: {:.2g} % of the longest shot are black",
                    step, time_text(last.exposure, step), 100 * last.dark));
  }
  if (first.clipped > kHighlightShare) {
    report.missing.push_back(fmt::format(
        "one more shot at -{:.0f} EV{}, or several, would reach the highlights: {:.2g} % of the shortest shot are "
        "clipped",
        step, time_text(first.exposure, -step), 100 * first.clipped));
  }
  for (std::size_t k = 1; k < report.shots.size(); ++k) {
    if (*report.shots[k].step <= kWidestStep) continue;
    report.missing.push_back(fmt::format("one more shot between {} and {}: they are {:.1f} EV apart",
                                         report.shots[k - 1].path.filename().string(),
                                         report.shots[k].path.filename().string(), *report.shots[k].step));
  }
}

}  // namespace

BracketReport report_bracket(const Bracket& bracket) {
  BracketReport report;
  Tally longest;
  bool nominal = true, uneven = false, linear = false;
  for (const Photo& shot : bracket.shots) {
    const Tally tally = tally_of(shot);
    ShotReport row{shot.path, shot.exposure, 0, std::nullopt, 0, 0};
    row.ev = std::log2(shot.relative_exposure() / bracket.shots.front().relative_exposure());
    if (!report.shots.empty()) row.step = row.ev - report.shots.back().ev;
    row.clipped = tally.share([](double code) { return code >= kClippedCode - 1.0 / Tally::kBins; });
    row.dark = tally.share([](double code) { return code < kDarkCode; });
    nominal &= shot.exposure.seconds && is_nominal(*shot.exposure.seconds);
    if (row.step) uneven |= std::abs(*row.step * 3 - std::round(*row.step * 3)) > 0.03;
    linear |= internal::is_raw_name(shot.path);
    report.shots.push_back(std::move(row));
    longest = tally;
  }
  if (report.shots.empty()) return report;
  report.span_ev = report.shots.back().ev;
  report.nominal_times = nominal && uneven;
  say_what_is_missing(report, longest, linear);
  return report;
}

}  // namespace hdr
