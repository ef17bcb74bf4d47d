#include "tools/hdr/report/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "tools/hdr/report/embed.h"
#include "tools/hdr/report/html.h"
#include "tools/hdr/report/plot_frame.h"

namespace hdr::report {
namespace {

constexpr double kTop = 10, kRight = 14, kBottom = 46;
constexpr double kDigit = 7.2;  ///< width of a digit of the labels, in the drawing's units

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void meet(double value, bool log) {
    if (!std::isfinite(value) || (log && value <= 0)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

void meet_all(Range& range, const std::vector<double>& values, bool log) {
  for (const double value : values) range.meet(value, log);
}

/// What the data span along x (or y).
Range range_of(const std::vector<Series>& series, bool log, bool vertical) {
  Range range;
  for (const Series& s : series) {
    const std::vector<double>& values = vertical ? s.y : s.x;
    meet_all(range, values, log);
    if (s.mark == Mark::kArrows) {
      const std::vector<double>& shifts = vertical ? s.high : s.low;
      for (std::size_t k = 0; k < values.size() && k < shifts.size(); ++k) range.meet(values[k] + shifts[k], log);
    } else if (s.mark == Mark::kBand ? vertical : s.mark == Mark::kSpans && !vertical) {
      meet_all(range, s.low, log);
    } else if (s.mark == Mark::kSteps && vertical && !log) {
      range.meet(0, false);
    }
    if (s.mark == Mark::kSpans && vertical) {
      for (const double row : s.y) range.meet(row - 0.6, log), range.meet(row + 0.6, log);
    }
  }
  return range;
}

/// The data's range with a little room, or the axis' own ends.
Scale scale_of(const Axis& axis, const Range& data) {
  Scale scale{axis.log, data.low, data.high, 0, 1};
  if (!(scale.low <= scale.high)) scale.low = axis.log ? 0.1 : 0, scale.high = 1;  // no data at all
  if (axis.log) {
    // Half a decade at least, around data that span less: a shorter axis may hold not one round number to be marked.
    constexpr double kShortest = 3.2;
    const double span = scale.high / scale.low;
    const double room = std::max(std::pow(span, 0.03), std::sqrt(kShortest / span));
    scale.low /= room;
    scale.high *= room;
  } else {
    const double span = scale.high - scale.low;
    const double room = span > 0 ? 0.03 * span : std::max(1e-3, 0.05 * std::abs(scale.high));
    const bool from_zero = scale.low == 0;
    scale.high += room;
    if (!from_zero) scale.low -= room;
  }
  if (axis.low) scale.low = *axis.low;
  if (axis.high) scale.high = *axis.high;
  if (axis.reversed) std::swap(scale.low, scale.high);
  return scale;
}

std::vector<Tick> ticks_of(const Axis& axis, const Scale& scale, int count) {
  if (!axis.ticks.empty()) return axis.ticks;
  const double low = std::min(scale.low, scale.high), high = std::max(scale.low, scale.high);
  return axis.log ? log_ticks(low, high, count) : linear_ticks(low, high, count);
}

/// Characters, not bytes: of UTF-8, those that do not continue another.
std::size_t length_of(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

std::string x_axis(const Plot& plot, const Frame& frame, const std::vector<Tick>& ticks) {
  std::string out = "<g class=\"axis\">";
  for (const Tick& tick : ticks) {
    const double x = frame.x(tick.value);
    if (!(x >= frame.left - 0.5 && x <= frame.right + 0.5)) continue;
    out += fmt::format("<line class=\"{}\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>",
                       tick.label.empty() ? "minor" : "grid", x, x, tick.label.empty() ? frame.bottom - 4 : frame.top,
                       frame.bottom);
    if (!tick.label.empty()) {
      out += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>", x, frame.bottom + 17,
                         escaped(tick.label));
    }
  }
  return out + fmt::format("<text class=\"label\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text></g>\n",
                           (frame.left + frame.right) / 2, frame.bottom + 38, escaped(plot.x.label));
}

std::string y_axis(const Plot& plot, const Frame& frame, const std::vector<Tick>& ticks) {
  std::string out = "<g class=\"axis\">";
  for (const Tick& tick : ticks) {
    const double y = frame.y(tick.value);
    if (!(y >= frame.top - 0.5 && y <= frame.bottom + 0.5)) continue;
    out += fmt::format("<line class=\"{}\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>",
                       tick.label.empty() ? "minor" : "grid", frame.left,
                       tick.label.empty() ? frame.left + 4 : frame.right, y, y);
    if (!tick.label.empty()) {
      out += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>", frame.left - 6, y + 4.5,
                         escaped(tick.label));
    }
  }
  if (!plot.y.label.empty()) {
    const double middle = (frame.top + frame.bottom) / 2;
    out += fmt::format(
        "<text class=\"label\" transform=\"translate(14 {:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>", middle,
        escaped(plot.y.label));
  }
  return out + "</g>\n";
}

std::string legend_of(const Plot& plot) {
  std::string out;
  for (const Series& series : plot.series) {
    if (!series.name.empty()) out += "<span>" + swatch_of(series) + escaped(series.name) + "</span> ";
  }
  return out.empty() ? out : "<p class=\"legend\">" + out + "</p>";
}

std::string quoted_csv(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

/// All numbers of the plot: series, x, y, low, high.
std::string csv_of(const Plot& plot) {
  const auto cell = [](const std::vector<double>& values, std::size_t k) {
    return k < values.size() && std::isfinite(values[k]) ? fmt::format("{:.6g}", values[k]) : std::string();
  };
  std::string out = "series," + quoted_csv(plot.x.label) + "," + quoted_csv(plot.y.label) + ",low,high\n";
  for (const Series& series : plot.series) {
    for (std::size_t k = 0; k < series.x.size(); ++k) {
      out += fmt::format("{},{},{},{},{}\n", quoted_csv(series.name), cell(series.x, k), cell(series.y, k),
                         cell(series.low, k), cell(series.high, k));
    }
  }
  return out;
}

/// For the script: the drawing's box, and what its edges mean.
std::string data_attributes(const Frame& frame) {
  const auto scale = [](const char* name, const Scale& s) {
    return fmt::format(" data-{}=\"{} {:.9g} {:.9g} {:.2f} {:.2f}\"", name, s.log ? "log" : "linear", s.low, s.high,
                       s.from, s.to);
  };
  return scale("x", frame.x) + scale("y", frame.y);
}

}  // namespace

Colour colour_of_channel(int channel) {
  return channel == 0 ? Colour::kVermilion : channel == 1 ? Colour::kGreen : Colour::kBlue;
}

Colour colour_in_turn(std::size_t k) {
  static constexpr Colour kTurn[] = {Colour::kBlue,   Colour::kVermilion, Colour::kGreen,
                                     Colour::kOrange, Colour::kPurple,    Colour::kSkyBlue};
  return kTurn[k % std::size(kTurn)];
}

std::string html_of(const Plot& plot) {
  Frame frame{scale_of(plot.x, range_of(plot.series, plot.x.log, false)),
              scale_of(plot.y, range_of(plot.series, plot.y.log, true)),
              0,
              kTop,
              plot.width - kRight,
              plot.height - kBottom};
  const std::vector<Tick> y_ticks = ticks_of(plot.y, frame.y, std::max(3, plot.height / 60));
  std::size_t widest = 1;
  for (const Tick& tick : y_ticks) widest = std::max(widest, length_of(tick.label));
  frame.left = std::min(0.45 * plot.width, (plot.y.label.empty() ? 8 : 26) + kDigit * static_cast<double>(widest) + 8);
  if (plot.equal_scale) {
    const double unit = (frame.right - frame.left) / std::abs(frame.x.high - frame.x.low);
    frame.bottom = frame.top + std::clamp(unit * std::abs(frame.y.high - frame.y.low), 40.0, 4.0 * plot.width);
  }
  frame.x.from = frame.left, frame.x.to = frame.right;
  frame.y.from = frame.bottom, frame.y.to = frame.top;
  const std::vector<Tick> x_ticks = ticks_of(plot.x, frame.x, std::max(3, plot.width / 80));
  std::string marks;
  for (const Series& series : plot.series) marks += svg_of(series, frame) + "\n";
  const std::string name = plot.title.empty() ? "plot" : plot.title;
  std::string out = plot.title.empty() ? std::string() : element("h3", plot.title);
  // The clip must have a name that no other plot of the page has: what it clips says it.
  const std::string clip = fmt::format("clip-{:.0f}-{:.0f}-{:.0f}-{:.0f}", 10 * frame.left, 10 * frame.top,
                                       10 * frame.right, 10 * frame.bottom);
  out += fmt::format("<svg class=\"plot\" viewBox=\"0 0 {} {:.0f}\" role=\"img\" aria-label=\"{}\"{}>\n", plot.width,
                     frame.bottom + kBottom, escaped(name), data_attributes(frame));
  out += fmt::format(
      "<clipPath id=\"{}\"><rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/></clipPath>\n", clip,
      frame.left - 1, frame.top - 1, frame.right - frame.left + 2, frame.bottom - frame.top + 2);
  out += x_axis(plot, frame, x_ticks) + y_axis(plot, frame, y_ticks);
  out += fmt::format("<rect class=\"frame\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>\n",
                     frame.left, frame.top, frame.right - frame.left, frame.bottom - frame.top);
  out += fmt::format("<g class=\"marks\" clip-path=\"url(#{})\">\n{}</g>\n</svg>\n", clip, marks) + legend_of(plot);
  return out + fmt::format(
                   "<p class=\"under\"><output class=\"readout\"></output> <a download=\"{}.csv\" "
                   "href=\"data:text/csv;base64,{}\">data (CSV)</a></p>\n",
                   escaped(name), base64(csv_of(plot)));
}

}  // namespace hdr::report
