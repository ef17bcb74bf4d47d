#include "tools/hdr/report_merge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libhdr/filter/tonemap.h"
#include "tools/hdr/report/html.h"
#include "tools/hdr/report/picture.h"
#include "tools/hdr/report/plot.h"
#include "tools/hdr/report_response.h"

namespace hdr::tools {
namespace {

using report::Colour;
using report::Mark;
using report::Plot;
using report::Series;

constexpr int kGreen = 1;

std::string percent(double share) {
  return report::number(100 * share, 2) + " %";
}

/// The luminances of which a shot's codes can be trusted: 5 to 250 of 255.
struct Reach {
  double low, high;  ///< log2 of radiance in the map's unit
};
Reach reach_of(const Photo& shot, const Response& response, double unit) {
  const double last = std::ldexp(1.0, response.bits) - 1;
  const double lowest = std::max(5 * last / 255, response.black_code(kGreen) + 1.0), highest = 250 * last / 255;
  const auto stop = [&](double code) {
    return (response.ln_exposure(kGreen, code) + std::log(unit / shot.relative_exposure())) / std::log(2.0);
  };
  return {stop(lowest), stop(highest)};
}

/// The axis that the scene and the shots share.
report::Axis luminance_axis(const MapDigest& digest, const std::vector<Reach>& reaches) {
  double low = digest.quantile(0), high = digest.quantile(1);
  if (std::isnan(low)) low = high = 0;
  for (const Reach& reach : reaches) {
    low = std::min(low, reach.low);
    high = std::max(high, reach.high);
  }
  return {"luminance (stops from the map's 1)", false, std::floor(low) - 1, std::ceil(high) + 1};
}

std::string scene_figure(const MapDigest& digest, const report::Axis& axis) {
  Plot plot;
  plot.title = "Luminances of the scene";
  plot.x = axis;
  plot.y = {"share of the pixels (%)", true};
  Series steps{"", Mark::kSteps, Colour::kSkyBlue};
  for (int k = 0; k <= MapDigest::kBins; ++k) {
    const double stop = MapDigest::kLowest + static_cast<double>(k) / MapDigest::kBinsAStop;
    if (stop < *axis.low || stop > *axis.high) continue;
    if (!steps.x.empty()) {
      const auto count = static_cast<double>(digest.luminances()[static_cast<std::size_t>(k - 1)]);
      steps.y.push_back(100 * count / static_cast<double>(digest.pixels()));
    }
    steps.x.push_back(stop);
  }
  plot.series = {std::move(steps)};
  return report::figure(html_of(plot), "A quarter of a stop each; logarithmic, since suns have few pixels.");
}

std::string reach_figure(const std::vector<Reach>& reaches, const MergeInputs& inputs, const MergeSummary& merged,
                         const report::Axis& axis) {
  Plot plot;
  plot.title = "What each shot shows of it";
  plot.x = axis;
  plot.y.reversed = true;
  Series used{"codes 5 to 250 of 255", Mark::kSpans, Colour::kBlue}, unused{"not used", Mark::kSpans, Colour::kOrange};
  for (std::size_t k = 0; k < reaches.size(); ++k) {
    const Photo& shot = inputs.bracket.shots[k];
    const auto row = static_cast<double>(k);
    plot.y.ticks.push_back({row, report::seconds_text(*shot.exposure.seconds)});
    Series& series = merged.frames[k].used ? used : unused;
    series.low.push_back(reaches[k].low);
    series.x.push_back(reaches[k].high);
    series.y.push_back(row);
    series.notes.push_back(
        fmt::format("{}: {:.1f} to {:.1f} stops", shot.path.filename().string(), reaches[k].low, reaches[k].high));
  }
  plot.height = 76 + 22 * static_cast<int>(reaches.size());
  plot.series = {std::move(used)};
  if (!unused.x.empty()) plot.series.push_back(std::move(unused));
  return report::figure(html_of(plot), "By the green channel. Luminances that no bar covers are bounds, not measures.");
}

std::string doubt_figure(const MapDigest& digest) {
  Plot plot;
  plot.title = "Doubt";
  plot.x = {"luminance (stops from the map's 1)"};
  plot.y = {"standard deviation of luminance (%)", true};
  Series middle{"half of the pixels are better", Mark::kLine, Colour::kBlue};
  Series most{"nine of ten are", Mark::kLine, Colour::kVermilion};
  most.dash = 1;
  for (int stop = MapDigest::kLowest; stop < MapDigest::kHighest; ++stop) {
    if (std::isnan(digest.doubt(stop, 0.5))) continue;
    for (auto [series, share] : {std::pair{&middle, 0.5}, std::pair{&most, 0.9}}) {
      series->x.push_back(stop + 0.5);
      series->y.push_back(100 * digest.doubt(stop, share));
    }
  }
  if (middle.x.empty()) return {};
  plot.series = {std::move(middle), std::move(most)};
  return report::figure(html_of(plot), "By the noise model; 100 % is a pixel of which only a bound is known.");
}

void add_coverage(report::Page& page, const MergeInputs& inputs, const MergeSummary& merged, const MapDigest& digest) {
  std::vector<Reach> reaches;
  for (const Photo& shot : inputs.bracket.shots) {
    reaches.push_back(reach_of(shot, inputs.response, merged.exposure_unit));
  }
  const report::Axis axis = luminance_axis(digest, reaches);
  page.add(
      {"coverage", "Exposure coverage",
       figures(page, {scene_figure(digest, axis), reach_figure(reaches, inputs, merged, axis), doubt_figure(digest)})});
}

void add_map(report::Page& page, const MergeSummary& merged, const MapDigest& digest, const std::string& drawing) {
  const auto pixels = static_cast<double>(std::max<std::int64_t>(1, digest.pixels()));
  report::Facts facts;
  facts.add("size", fmt::format("{} x {}", digest.size().width, digest.size().height));
  facts.add("range", report::number(merged.stops, 3) + " stops");
  facts.add("clipped in every shot", percent(static_cast<double>(merged.clipped) / pixels));
  facts.add("dark in every shot", percent(static_cast<double>(merged.dark) / pixels));
  if (!std::isnan(digest.doubt(0.5))) facts.add("deviation, median", percent(digest.doubt(0.5)));
  if (!merged.ghosts.regions.empty()) facts.add("ghosts", percent(merged.ghosts.share));
  const Image<float>& small = digest.picture();
  report::Picture picture{"map-picture", small, metered_stops(small), {}, drawing, digest.size()};
  picture.overlays.push_back({"clipped", digest.clipped(), Colour::kVermilion, false});
  picture.overlays.push_back({"dark", digest.dark(), Colour::kSkyBlue, false});
  Image<std::uint8_t> ghosts;
  if (!merged.ghosts.mask.empty()) {
    ghosts = report::reduced(merged.ghosts.mask.view(), small.size());
    picture.overlays.push_back({"ghosts: a shot was left out", ghosts, Colour::kPurple, true});
  }
  page.add({"map", "The radiance map", facts.html() + html_of(picture, page)});
}

void add_shots(report::Page& page, const Json& frames) {
  const bool gains = !frames.empty() && frames[0].contains("gain");
  std::vector<report::Table::Column> columns = {{"shot"}, {"exposure", true}, {"used"}, {"why not"}};
  if (gains) columns.insert(columns.end(), {{"gain", true}, {"deviation", true}});
  report::Table table(columns);
  for (const Json& frame : frames) {
    std::vector<std::string> row = {Path(frame["path"].get<std::string>()).filename().string(),
                                    report::seconds_text(frame["seconds"]), frame["used"] ? "yes" : "no",
                                    frame.value("skipped", std::string())};
    if (gains) {
      row.push_back(report::number(frame["gain"], 4));
      row.push_back(frame["gain_deviation"].is_number() ? report::number(frame["gain_deviation"], 2)
                                                        : frame.value("gain_unknown", std::string()));
    }
    table.row(std::move(row));
  }
  page.add({"shots", "Shots", table.html()});
}

/// Where pixels of the shots moved, on a few places of the picture, drawn larger than they are.
std::string shift_figure(const Bracket& bracket, const Alignment& alignment) {
  constexpr int kColumns = 4, kRows = 3;
  const Size size = bracket.size();
  const auto place = [&](int k) {
    return Vec3((k % kColumns + 0.5) / kColumns * size.width, (k / kColumns + 0.5) / kRows * size.height, 1);
  };
  const auto shift = [&](std::size_t shot, int k) {
    const Vec3 moved = alignment.frames[shot].ref_from_photo * place(k);
    return Vec2((moved.head<2>() / moved.z() - place(k).head<2>()).eval());
  };
  double most = 0;
  for (std::size_t shot = 0; shot < bracket.shots.size(); ++shot) {
    for (int k = 0; k < kColumns * kRows; ++k) most = std::max(most, shift(shot, k).norm());
  }
  if (most < 1e-3) return {};
  const double zoom = std::exp2(std::floor(std::log2(0.2 * size.width / kColumns / most * 4)));
  Plot plot;
  plot.title = "Shifts of the shots onto the reference";
  plot.x = {"x (px)", false, 0.0, size.width};
  plot.y = {"y (px)", false, 0.0, size.height};
  plot.y.reversed = true;
  plot.equal_scale = true;
  for (std::size_t shot = 0; shot < bracket.shots.size(); ++shot) {
    if (static_cast<int>(shot) == alignment.reference) continue;
    Series arrows{report::seconds_text(*bracket.shots[shot].exposure.seconds), Mark::kArrows,
                  report::colour_in_turn(shot)};
    for (int k = 0; k < kColumns * kRows; ++k) {
      const Vec2 moved = shift(shot, k);
      arrows.x.push_back(place(k).x());
      arrows.y.push_back(place(k).y());
      arrows.low.push_back(zoom * moved.x());
      arrows.high.push_back(zoom * moved.y());
      arrows.notes.push_back(
          fmt::format("{}: {:.2f}, {:.2f} px", bracket.shots[shot].path.filename().string(), moved.x(), moved.y()));
    }
    plot.series.push_back(std::move(arrows));
  }
  return report::figure(html_of(plot), fmt::format("Arrows are {:g} times as long as the shifts; the longest is {:.2f} "
                                                   "px.",
                                                   zoom, most));
}

}  // namespace

void add_alignment(report::Page& page, const Bracket& bracket, const Alignment& alignment) {
  if (bracket.shots.size() < 2) return;
  report::Table table({{"shot"},
                       {"shift of the middle (px)", true},
                       {"turn (degrees)", true},
                       {"residual (px)", true},
                       {"tiles that agree", true},
                       {"note"}});
  Plot plot;
  plot.title = "What registration leaves";
  plot.x = {"residual (px, rms over the picture)", false, 0.0};
  plot.y.reversed = true;
  Series bars{"", Mark::kSpans, Colour::kBlue};
  const Vec3 middle(0.5 * bracket.size().width, 0.5 * bracket.size().height, 1);
  for (std::size_t k = 0; k < alignment.frames.size(); ++k) {
    const FrameAlignment& frame = alignment.frames[k];
    const Mat3& m = frame.ref_from_photo;
    const Vec3 moved = m * middle;
    const Vec2 shift = moved.head<2>() / moved.z() - middle.head<2>();
    const bool reference = static_cast<int>(k) == alignment.reference;
    const std::string name = bracket.shots[k].path.filename().string();
    table.row({name, report::number(shift.x()) + ", " + report::number(shift.y()),
               report::number(std::atan2(m(1, 0), m(0, 0)) * 180 / M_PI, 2), report::number(frame.residual_px),
               percent(frame.inliers), reference ? "the reference" : frame.skipped});
    plot.y.ticks.push_back({static_cast<double>(k), report::seconds_text(*bracket.shots[k].exposure.seconds)});
    bars.low.push_back(0);
    bars.x.push_back(frame.residual_px);
    bars.y.push_back(static_cast<double>(k));
    bars.notes.push_back(name + ": " + report::number(frame.residual_px) + " px");
  }
  plot.height = 76 + 22 * static_cast<int>(alignment.frames.size());
  plot.series = {std::move(bars)};
  page.add({"alignment", "Alignment",
            figures(page, {report::figure(html_of(plot), ""), shift_figure(bracket, alignment)}) + table.html()});
}

void add_merge(report::Page& page, const Run& run, const MergeInputs& inputs, const MergeSummary& merged,
               const MapDigest& digest, const std::string& drawing) {
  add_map(page, merged, digest, drawing);
  add_coverage(page, inputs, merged, digest);
  add_shots(page, run.answer["frames"]);
  add_alignment(page, inputs.bracket, inputs.alignment);
  add_response(page, inputs.bracket, inputs.alignment, inputs.response, inputs.fit ? &*inputs.fit : nullptr);
  if (run.answer.contains("exposures")) add_exposures(page, run.answer["exposures"]);
}

}  // namespace hdr::tools
