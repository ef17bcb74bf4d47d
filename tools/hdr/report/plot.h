#pragma once
// Plots as SVG: axes with their units, logarithmic where asked for, colours that the colour-blind can tell apart
// [Okabe08] and dashes besides. A script adds a read-out under the pointer; without it all is there.
#include <optional>
#include <string>
#include <vector>

#include "tools/hdr/report/ticks.h"

namespace hdr::report {

/// The order of [Okabe08]'s palette as style.css has it. kInk is black on white, white on black.
enum class Colour { kInk, kOrange, kSkyBlue, kGreen, kYellow, kBlue, kVermilion, kPurple };
/// For red, green and blue.
Colour colour_of_channel(int channel);
/// For things that are many: the k-th of those above that are legible on both grounds, round and round.
Colour colour_in_turn(std::size_t k);

enum class Mark {
  kLine,
  kPoints,
  kCurve,  ///< points, each a mark of the series' shape, and a thin line through them
  kSteps,  ///< y[k] from x[k] to x[k + 1] (x one longer than y), filled down to the axis
  kBand,   ///< between low[k] and y[k]
  kSpans,  ///< from low[k] to x[k] at height y[k]: bars that lie
  kArrows  ///< from (x[k], y[k]) to (x[k] + dx, y[k] + dy), with low = dx and high = dy, in units of the axes
};

/// Values that are not finite, or not positive on a logarithmic axis, leave a gap.
struct Series {
  std::string name;  ///< in the legend and the data; empty: not in the legend
  Mark mark = Mark::kLine;
  Colour colour = Colour::kInk;
  std::vector<double> x, y;
  std::vector<double> low, high;   ///< as the mark says
  int dash = 0;                    ///< of lines: 0 none, 1 .. 3
  int shape = 0;                   ///< of points: 0 disc, 1 square, 2 triangle, 3 diamond
  std::vector<std::string> notes;  ///< a text for each point, shown under the pointer; may be empty
};

struct Axis {
  std::string label;  ///< with its unit: "radiance (stops)"
  bool log = false;
  std::optional<double> low, high;  ///< absent: what the data span, and a little more
  std::vector<Tick> ticks;          ///< empty: chosen
  bool reversed = false;            ///< y grows downwards, as rows of a picture do
};

struct Plot {
  std::string title;
  Axis x, y;
  std::vector<Series> series;
  int width = 520, height = 340;  ///< of the drawing; it scales with the page
  bool equal_scale = false;       ///< a unit is as long in x as in y: `height` follows
};

/// <svg> with title, legend and the data as CSV to take away; belongs into a figure().
std::string html_of(const Plot& plot);

}  // namespace hdr::report
