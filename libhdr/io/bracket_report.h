#pragma once
// What a bracket covers and what it lacks, told before anything is computed from it (`hdr info SHOTS`).
#include <optional>
#include <string>
#include <vector>

#include "libhdr/core/photo.h"

namespace hdr {

struct ShotReport {
  Path path;
  Exposure exposure;
  double ev = 0;                 ///< log2 of the relative exposure over the shortest shot's
  std::optional<double> step;    ///< EV from the shot before, in rising order
  double clipped = 0, dark = 0;  ///< shares of the pixels: a channel within 1 % of the top; all below 2 % of it
};

struct BracketReport {
  std::vector<ShotReport> shots;  ///< in rising order of exposure
  double span_ev = 0;             ///< from the shortest to the longest
  bool nominal_times = false;     ///< times as on a camera's dial, 1/60 for 1/64 s: the shutter's are up to 6 % off
  /// Sentences: "one more shot at +2 EV (1/4 s) would cover the shadows: ..."; empty when nothing is missing.
  std::vector<std::string> missing;
};

/// Codes are read once. Shadows count as covered when less than 0.1 % of the longest shot is dark, highlights when less
/// than 0.01 % of the shortest is clipped; codes are taken as sRGB (16-bit ones of raw files as linear), for want of a
/// response. A gap of more than 4 EV between neighbours is missing too: few codes are good in both.
BracketReport report_bracket(const Bracket& bracket);

}  // namespace hdr
