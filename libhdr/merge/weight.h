#pragma once
// How much a code is worth: weights of linear radiance, a function of the code alone and so a table.
#include <vector>

#include "libhdr/merge/merge.h"

namespace hdr {

/// Codes from `clipped` up may stand for any amount of light.
int first_clipped_code(int bits, bool lossy);

/// Weight of each code 0 .. 2^bits - 1 of `channel`: 0 at black and at clipped codes, below 1e4 and above 1e-8
/// between. Only ratios between shots matter, and for one radiance those of the relative variance of exp(g).
///   kHat       the hat, squared: falls to zero at both ends faster than [Debevec97] eq. 4, because what JPEG does to
///              codes near the ends (chroma subsampling, ringing) is worse than their rounding
///   kVariance  1 / relative variance of exp(g) from rounding, shot and read noise, with a short ramp under clipping
///   (and over a
///              pedestal, whose noise reaches above it)
///   kAuto      kHat for lossy files, kVariance for lossless ones
std::vector<float> code_weights(const Response& response, int channel, bool lossy, WeightKind kind);

}  // namespace hdr
