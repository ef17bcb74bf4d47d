#include "tools/hdr/report_response.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libhdr/response/fragments.h"
#include "tools/hdr/report/html.h"
#include "tools/hdr/report/plot.h"

namespace hdr::tools {
namespace {

using report::Mark;
using report::Plot;
using report::Series;

constexpr int kPoints = 120;        ///< of each channel
constexpr std::size_t kDrawn = 14;  ///< fragments that are drawn one by one
constexpr const char* kChannels[] = {"red", "green", "blue"};
constexpr int kGreen = 1;

using Fragments = std::vector<CurveFragment>;

double off_curve(const Response& response, int channel, const CurveFragment& f, std::size_t k) {
  return response.ln_exposure(channel, f.codes[k]) - f.ln_radiance - f.ln_exposure[k];
}

/// From black to where the curve ends.
report::Axis axis_of_codes(const Response& response, const char* label) {
  return {label, false, 0, response.code_from_level(response.levels() - 1)};
}

Series curve_of(const Response& response, int channel, const std::string& name) {
  Series curve{name, Mark::kLine, report::colour_of_channel(channel)};
  curve.dash = channel;
  const int levels = response.levels(), step = std::max(1, levels / 256);
  for (int k = 0; k < levels; k += step) {
    curve.x.push_back(response.code_from_level(k));
    curve.y.push_back(response.g[static_cast<std::size_t>(channel)][static_cast<std::size_t>(k)]);
  }
  return curve;
}

/// Two standard deviations either way.
Series doubt_of(const Response& response, int channel, const std::vector<double>& deviation) {
  Series band{"", Mark::kBand, report::colour_of_channel(channel)};
  const int levels = response.levels(), step = std::max(1, levels / 256);
  for (int k = 0; k < levels && static_cast<std::size_t>(k) < deviation.size(); k += step) {
    const auto level = static_cast<std::size_t>(k);
    const double g = response.g[static_cast<std::size_t>(channel)][level];
    band.x.push_back(response.code_from_level(k));
    band.y.push_back(g + 2 * deviation[level]);
    band.low.push_back(g - 2 * deviation[level]);
  }
  return band;
}

/// The curve's lower end is 8 and more below the middle, and would press all else together.
double lowest_shown(const Response& response) {
  double least = 0;
  for (const auto& g : response.g) {
    const std::size_t dark = g.size() / 64;
    least = std::min(least, g[dark]);
  }
  return least - 0.5;
}

std::string curves_figure(const Response& response, const std::array<Fragments, 3>& fragments, const Calibration* fit) {
  Plot plot;
  plot.title = "Response";
  plot.x = axis_of_codes(response, "code");
  plot.y = {"g(code): ln exposure, 0 at the middle code", false, lowest_shown(response)};
  for (int c = 0; c < 3; ++c) {
    const auto channel = static_cast<std::size_t>(c);
    Series points{"", Mark::kPoints, report::colour_of_channel(c)};
    for (const CurveFragment& f : fragments[channel]) {
      for (std::size_t k = 0; k < f.codes.size(); ++k) {
        points.x.push_back(f.codes[k]);
        points.y.push_back(f.ln_radiance + f.ln_exposure[k]);
      }
    }
    if (fit && !fit->deviation[channel].empty()) plot.series.push_back(doubt_of(response, c, fit->deviation[channel]));
    plot.series.push_back(std::move(points));
    plot.series.push_back(curve_of(response, c, kChannels[c]));
  }
  return report::figure(html_of(plot), fit && !fit->deviation[0].empty()
                                           ? "Dots: pixels, each place of the scene shifted by its ln E. Bands: two "
                                             "standard deviations of the fit."
                                           : "Dots: pixels, each place of the scene shifted by its ln E.");
}

/// Some that span the scene: of each stretch of luminance the one that most shots saw.
std::vector<const CurveFragment*> chosen(const Fragments& fragments) {
  std::vector<const CurveFragment*> sorted;
  for (const CurveFragment& f : fragments) sorted.push_back(&f);
  std::stable_sort(sorted.begin(), sorted.end(), [](auto* a, auto* b) { return a->ln_radiance < b->ln_radiance; });
  const std::size_t count = std::min(kDrawn, sorted.size());
  std::vector<const CurveFragment*> some;
  for (std::size_t k = 0; k < count; ++k) {
    some.push_back(*std::max_element(sorted.begin() + static_cast<std::ptrdiff_t>(k * sorted.size() / count),
                                     sorted.begin() + static_cast<std::ptrdiff_t>((k + 1) * sorted.size() / count),
                                     [](auto* a, auto* b) { return a->codes.size() < b->codes.size(); }));
  }
  return some;
}

std::string fragments_figure(const Response& response, const Fragments& fragments, bool shifted) {
  Plot plot;
  plot.title = shifted ? "The same pixels after their shift" : "Single pixels: fragments of g";
  plot.x = axis_of_codes(response, "code (green)");
  plot.y = {shifted ? "ln H + ln E" : "ln H, exposure of the shot"};
  std::size_t turn = 0;
  for (const CurveFragment* f : chosen(fragments)) {
    const double shift = shifted ? f->ln_radiance : 0;
    for (const Mark mark : {Mark::kLine, Mark::kPoints}) {
      Series series{"", mark, report::colour_in_turn(turn), f->codes, {}};
      for (const double h : f->ln_exposure) series.y.push_back(h + shift);
      if (mark == Mark::kPoints) {
        series.notes.assign(series.x.size(), fmt::format("a pixel with ln E = {:.2f}", f->ln_radiance));
      }
      plot.series.push_back(std::move(series));
    }
    ++turn;
  }
  if (shifted) {
    Series curve = curve_of(response, kGreen, "g");
    curve.colour = report::Colour::kInk;
    curve.dash = 1;
    plot.series.push_back(std::move(curve));
    plot.y.low = lowest_shown(response);
  }
  return report::figure(html_of(plot), shifted ? "Each moved by one number, its ln E: they lie on one curve."
                                               : "The codes of a pixel in the shots that show it: a piece of the "
                                                 "curve, at a height that is not known yet.");
}

std::string residuals_figure(const Response& response, const std::array<Fragments, 3>& fragments) {
  Plot plot;
  plot.title = "How far the pixels are from the curve";
  plot.x = axis_of_codes(response, "code");
  plot.y = {"g(code) - ln E - ln H (%)"};
  for (int c = 0; c < 3; ++c) {
    Series points{kChannels[c], Mark::kPoints, report::colour_of_channel(c)};
    for (const CurveFragment& f : fragments[static_cast<std::size_t>(c)]) {
      for (std::size_t k = 0; k < f.codes.size(); ++k) {
        points.x.push_back(f.codes[k]);
        points.y.push_back(100 * off_curve(response, c, f, k));
      }
    }
    plot.series.push_back(std::move(points));
  }
  return report::figure(html_of(plot), "Noise scatters around 0; a bend that all share is an error of the curve.");
}

std::string codes_figure(const Response& response, const std::array<Fragments, 3>& fragments) {
  constexpr int kBins = 32;
  const double last = std::ldexp(1.0, response.bits) - 1, bin = (last + 1) / kBins;
  Plot plot;
  plot.title = "Which codes had data";
  plot.x = {"code"};
  plot.y = {"pixels"};
  for (int c = 0; c < 3; ++c) {
    Series counts{kChannels[c], Mark::kSteps, report::colour_of_channel(c)};
    for (int k = 0; k <= kBins; ++k) counts.x.push_back(k * bin);
    counts.y.assign(kBins, 0);
    for (const CurveFragment& f : fragments[static_cast<std::size_t>(c)]) {
      for (const double code : f.codes) ++counts.y[static_cast<std::size_t>(std::clamp(code / bin, 0.0, kBins - 1.0))];
    }
    plot.series.push_back(std::move(counts));
  }
  return report::figure(html_of(plot),
                        "Codes next to black and white have no weight: there the curve follows from its smoothness.");
}

}  // namespace

void add_response(report::Page& page, const Bracket& bracket, const Alignment& alignment, const Response& response,
                  const Calibration* fit) {
  const auto fragments =
      curve_fragments(bracket, alignment.identity() ? std::vector<Mat3>{} : alignment.ref_from_photo(), response,
                      fit ? fit->seconds : std::vector<double>{}, kPoints);
  std::string html;
  if (fit) {
    report::Facts facts;
    facts.add("rms of ln exposure", report::number(fit->rms_log_error));
    facts.add("converged", fit->converged ? "yes" : "no");
    facts.add("points", std::to_string(fit->pixels));
    facts.add("smoothness", report::number(fit->smoothness));
    html = facts.html();
  } else {
    html = "<p>The response was given, not fitted; the dots are what these shots say of it.</p>\n";
  }
  std::vector<std::string> plots = {curves_figure(response, fragments, fit)};
  if (!fragments[kGreen].empty()) {
    plots.push_back(residuals_figure(response, fragments));
    plots.push_back(fragments_figure(response, fragments[kGreen], false));
    plots.push_back(fragments_figure(response, fragments[kGreen], true));
    plots.push_back(codes_figure(response, fragments));
  }
  page.add({"response", "Response of the camera", html + figures(page, plots)});
}

void add_exposures(report::Page& page, const Json& exposures) {
  report::Table table({{"shot"}, {"label", true}, {"as used", true}, {"difference (stops)", true}});
  Plot plot;
  plot.title = "Exposure times: as used, over their labels";
  plot.x = {"shot"};
  plot.y = {"log2 of the ratio (stops)"};
  Series points{"", Mark::kPoints, report::Colour::kBlue};
  bool differ = false;
  for (const Json& row : exposures) {
    const double label = row["seconds"], used = row["refined_seconds"], stops = std::log2(used / label);
    const std::string name = Path(row["path"].get<std::string>()).filename().string();
    table.row({name, report::seconds_text(label), report::seconds_text(used), report::number(stops, 2)});
    points.x.push_back(static_cast<double>(points.x.size() + 1));
    points.y.push_back(stops);
    points.notes.push_back(name + ": " + report::number(stops, 2) + " stops");
    differ = differ || std::abs(stops) > 1e-9;
  }
  plot.series = {std::move(points)};
  const std::string picture = differ ? figures(page, {report::figure(html_of(plot), "")}) : std::string();
  page.add({"exposures", "Exposures", picture + table.html()});
}

}  // namespace hdr::tools
