#pragma once
// Light that changed from shot to shot (a lamp that flickers, a cloud): one gain a shot, from the shots themselves.
//
// The median of ln radiance over that of a neighbour in exposure, over cells that both expose well, is the difference
// of their gains; neighbours and next neighbours are joined by weighted least squares. What shots cannot tell from
// something else is left alone: a common factor is the scene's, and a slope of the gains against ln exposure is the
// response's. So ln gains have mean zero and no slope against ln exposure. That holds among the shots that shared cells
// join to each other, the largest such group; any other shot, and each of two, has gain 1 and the reason. A shutter off
// its label changes the light too: what counts is light times time. The deviation is that of the medians [Hampel74],
// block by block, since what errs alike (compression, a response) does so in neighbours, and is widened where the ratios
// contradict each other. A response that is not the camera's adds an error of its own (.003 was seen with the right one
// behind JPEG, .012 with one that was fitted to the drifting shots themselves).
#include <optional>
#include <string>
#include <vector>

#include "libhdr/align/align.h"
#include "libhdr/core/photo.h"
#include "libhdr/response/response.h"

namespace hdr {

struct FrameGain {
  double gain = 1;                  ///< the light of this shot over that of the bracket
  std::optional<double> deviation;  ///< standard deviation of ln gain; nothing: not measured, and gain is 1
  std::string unknown;              ///< why not: "left out of the merge"; empty when it was measured, or not asked for
};

/// One for each shot of the bracket. Reads the rows of every shot once. Shots that are `left_out` (empty: none) say
/// nothing. What moves, or is not registered, matters little: medians.
std::vector<FrameGain> estimate_drift(const Bracket& bracket, const Alignment& alignment, const Response& response,
                                      const std::vector<bool>& left_out = {});

}  // namespace hdr
