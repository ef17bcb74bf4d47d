#pragma once
// From data to the drawing's units: what plot.cpp and marks.cpp share.
#include <cmath>
#include <string>

#include "tools/hdr/report/plot.h"

namespace hdr::report {

/// One axis: data low .. high lie between the drawing's from and to.
struct Scale {
  bool log = false;
  double low = 0, high = 1;
  double from = 0, to = 1;

  /// NaN where there is no place: not finite, or not positive on a logarithmic axis.
  double operator()(double value) const {
    const double at = log ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
    return std::isfinite(at) ? from + at * (to - from) : std::nan("");
  }
};

struct Frame {
  Scale x, y;
  double left = 0, top = 0, right = 0, bottom = 0;
};

/// SVG of one series inside the frame.
std::string svg_of(const Series& series, const Frame& frame);
/// The same mark in small, for the legend.
std::string swatch_of(const Series& series);

}  // namespace hdr::report
