// The marks of a plot: lines, points, steps, bands, spans, arrows.
#include <fmt/format.h>

#include <algorithm>

#include "libhdr/core/error.h"
#include "tools/hdr/report/html.h"
#include "tools/hdr/report/plot_frame.h"

namespace hdr::report {
namespace {

/// "c3 d1": the colour and the dash that style.css gives to it.
std::string classes(const Series& series, const char* mark) {
  std::string text = fmt::format("{} c{}", mark, static_cast<int>(series.colour));
  if (series.dash > 0) text += fmt::format(" d{}", series.dash);
  return text;
}

std::string point_text(double x, double y) {
  return fmt::format("{:.1f} {:.1f}", x, y);
}

std::string note(const Series& series, std::size_t k) {
  return k < series.notes.size() ? element("title", series.notes[k]) : std::string();
}

std::string line(const Series& series, const Frame& frame) {
  std::string path;
  bool drawing = false;
  for (std::size_t k = 0; k < series.x.size(); ++k) {
    const double x = frame.x(series.x[k]), y = frame.y(series.y[k]);
    if (!std::isfinite(x) || !std::isfinite(y)) {
      drawing = false;
      continue;
    }
    path += (drawing ? "L" : "M") + point_text(x, y);
    drawing = true;
  }
  return fmt::format("<path class=\"{}\" data-name=\"{}\" d=\"{}\"/>", classes(series, "line"), escaped(series.name),
                     path);
}

/// A point as large to the eye whatever its shape.
std::string dot(int shape, double x, double y, double r, const std::string& inside) {
  if (shape == 0) return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\">{}</circle>", x, y, r, inside);
  std::string path;
  if (shape == 1) {
    const double a = 0.9 * r;
    path = fmt::format("M{:.1f} {:.1f}h{:.1f}v{:.1f}h{:.1f}Z", x - a, y - a, 2 * a, 2 * a, -2 * a);
  } else if (shape == 2) {
    path = fmt::format("M{:.1f} {:.1f}l{:.1f} {:.1f}h{:.1f}Z", x, y - 1.3 * r, 1.2 * r, 2.1 * r, -2.4 * r);
  } else {
    const double a = 1.3 * r;
    path = fmt::format("M{:.1f} {:.1f}l{:.1f} {:.1f}l{:.1f} {:.1f}l{:.1f} {:.1f}Z", x, y - a, a, a, -a, a, -a, -a);
  }
  return fmt::format("<path d=\"{}\">{}</path>", path, inside);
}

std::string points(const Series& series, const Frame& frame) {
  std::string out = fmt::format("<g class=\"{}\">", classes(series, "points"));
  const double radius = series.x.size() > 200 ? 1.5 : series.x.size() > 40 ? 2.2 : 3.5;
  for (std::size_t k = 0; k < series.x.size(); ++k) {
    const double x = frame.x(series.x[k]), y = frame.y(series.y[k]);
    if (!std::isfinite(x) || !std::isfinite(y)) continue;
    out += dot(series.shape, x, y, radius, note(series, k));
  }
  return out + "</g>";
}

std::string steps(const Series& series, const Frame& frame) {
  HDR_ASSERT(series.x.size() == series.y.size() + 1);
  // Where there is no place, as for zero on a logarithmic axis, a step begins at the edge.
  const auto edge = [&](std::size_t k) {
    const double x = frame.x(series.x[k]);
    return std::isfinite(x) ? x : frame.left;
  };
  std::string path = "M" + point_text(edge(0), frame.bottom);
  for (std::size_t k = 0; k < series.y.size(); ++k) {
    const double y = frame.y(series.y[k]), height = std::isfinite(y) ? y : frame.bottom;
    path += "L" + point_text(edge(k), height) + "L" + point_text(edge(k + 1), height);
  }
  path += "L" + point_text(edge(series.y.size()), frame.bottom) + "Z";
  return fmt::format("<path class=\"{}\" d=\"{}\"/>", classes(series, "area"), path);
}

std::string band(const Series& series, const Frame& frame) {
  HDR_ASSERT(series.low.size() == series.x.size());
  std::string out;
  for (std::size_t first = 0; first < series.x.size();) {
    const auto drawable = [&](std::size_t k) {
      return std::isfinite(frame.x(series.x[k])) && std::isfinite(frame.y(series.y[k])) &&
             std::isfinite(frame.y(series.low[k]));
    };
    std::size_t last = first;
    while (last < series.x.size() && drawable(last)) ++last;
    std::string path;
    for (std::size_t k = first; k < last; ++k) {
      path += (k == first ? "M" : "L") + point_text(frame.x(series.x[k]), frame.y(series.y[k]));
    }
    for (std::size_t k = last; k-- > first;) path += "L" + point_text(frame.x(series.x[k]), frame.y(series.low[k]));
    if (!path.empty()) out += fmt::format("<path class=\"{}\" d=\"{}Z\"/>", classes(series, "band"), path);
    first = last + 1;
  }
  return out;
}

std::string spans(const Series& series, const Frame& frame) {
  HDR_ASSERT(series.low.size() == series.x.size());
  std::string out = fmt::format("<g class=\"{}\">", classes(series, "spans"));
  const double row = std::abs(frame.y(1) - frame.y(0));
  const double height = std::clamp(std::isfinite(row) ? 0.7 * row : 10, 2.0, 16.0);
  for (std::size_t k = 0; k < series.x.size(); ++k) {
    const double x0 = std::clamp(frame.x(series.low[k]), frame.left, frame.right);
    const double x1 = std::clamp(frame.x(series.x[k]), frame.left, frame.right), y = frame.y(series.y[k]);
    if (!std::isfinite(x0) || !std::isfinite(x1) || !std::isfinite(y)) continue;
    out += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" rx=\"2\">{}</rect>",
                       std::min(x0, x1), y - height / 2, std::max(1.0, std::abs(x1 - x0)), height, note(series, k));
  }
  return out + "</g>";
}

std::string arrows(const Series& series, const Frame& frame) {
  HDR_ASSERT(series.low.size() == series.x.size() && series.high.size() == series.x.size());
  std::string out = fmt::format("<g class=\"{}\">", classes(series, "arrows"));
  for (std::size_t k = 0; k < series.x.size(); ++k) {
    const double x0 = frame.x(series.x[k]), y0 = frame.y(series.y[k]);
    const double x1 = frame.x(series.x[k] + series.low[k]), y1 = frame.y(series.y[k] + series.high[k]);
    if (!std::isfinite(x0 + y0 + x1 + y1)) continue;
    const double length = std::hypot(x1 - x0, y1 - y0), angle = std::atan2(y1 - y0, x1 - x0);
    const double head = std::min(6.0, 0.5 * length);
    std::string path = "M" + point_text(x0, y0) + "L" + point_text(x1, y1);
    for (const double turn : {-0.45, 0.45}) {
      path += "M" + point_text(x1 - head * std::cos(angle + turn), y1 - head * std::sin(angle + turn)) + "L" +
              point_text(x1, y1);
    }
    out += fmt::format("<path d=\"{}\">{}</path><circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"1.5\"/>", path, note(series, k),
                       x0, y0);
  }
  return out + "</g>";
}

}  // namespace

std::string svg_of(const Series& series, const Frame& frame) {
  if (series.x.empty()) return {};
  HDR_ASSERT(series.mark == Mark::kSteps || series.x.size() == series.y.size());
  switch (series.mark) {
    case Mark::kPoints:
      return points(series, frame);
    case Mark::kCurve:
      return line(series, frame) + points(series, frame);
    case Mark::kSteps:
      return steps(series, frame);
    case Mark::kBand:
      return band(series, frame);
    case Mark::kSpans:
      return spans(series, frame);
    case Mark::kArrows:
      return arrows(series, frame);
    case Mark::kLine:
      break;
  }
  return line(series, frame);
}

std::string swatch_of(const Series& series) {
  Series small = series;
  small.notes.clear();
  Frame frame{{false, 0, 22, 0, 22}, {false, 0, 12, 0, 12}, 0, 0, 22, 12};
  small.x = {1, 21};
  small.y = {6, 6};
  if (series.mark == Mark::kCurve) {
    small.x = {1, 11, 21};
    small.y = {6, 6, 6};
    Series mark = small;
    mark.mark = Mark::kPoints;
    mark.x = {11}, mark.y = {6};
    small.mark = Mark::kLine;
    return "<svg class=\"swatch\" viewBox=\"0 0 22 12\" width=\"22\" height=\"12\" aria-hidden=\"true\">" +
           svg_of(small, frame) + svg_of(mark, frame) + "</svg>";
  }
  if (series.mark == Mark::kPoints) small.x = {11}, small.y = {6};
  if (series.mark == Mark::kSteps) small.y = {2};
  if (series.mark == Mark::kBand) small.y = {2, 2}, small.low = {10, 10};
  if (series.mark == Mark::kSpans) small.x = {21}, small.y = {0.5}, small.low = {1}, frame.y = {false, 0, 1, 0, 12};
  if (series.mark == Mark::kArrows) small.x = {2}, small.y = {6}, small.low = {18}, small.high = {0};
  return "<svg class=\"swatch\" viewBox=\"0 0 22 12\" width=\"22\" height=\"12\" aria-hidden=\"true\">" +
         svg_of(small, frame) + "</svg>";
}

}  // namespace hdr::report
