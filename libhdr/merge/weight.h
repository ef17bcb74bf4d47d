#pragma once
// How much a code is worth: a function of the code alone, and so a table.
#include <vector>

#include "libhdr/merge/merge.h"

namespace hdr {

/// Codes from here up may stand for any amount of light.
int first_clipped_code(int bits, bool lossy);

/// For each code 0 .. 2^bits - 1 of `channel`, exp(g) / variance of exp(g), up to a factor common to all codes; 0 for
/// black and for clipped codes. A shot of exposure H measures radiance exp(g) / H with H times this weight.
///
/// Why not the weight of maximum likelihood, H^2 / variance, nor that of the relative error, exp(g)^2 / variance? They
/// agree where all shots see one radiance, H ~ exp(g). Where they do not, the first believes the darker shot (blur and
/// misregistration beside bright things), the second the brighter one (read noise that lifts black a little in a short
/// exposure is a great radiance). The geometric mean of the two treats both alike, as a mean of logarithms would.
///
///   kHat       relative deviation 1 % / hat: the relative weight, hat^2, falls to zero at both ends faster than the
///   hat
///              of [Debevec97] eq. 4, because what JPEG does to codes near the ends (chroma subsampling, ringing) is
///              worse than their rounding; plus the sensor's noise
///   kVariance  rounding, shot and read noise, with a short ramp under clipping (and over a pedestal, whose noise
///              reaches above it)
///   kAuto      kHat for lossy files, kVariance for lossless ones
std::vector<float> code_weights(const Response& response, int channel, bool lossy, WeightKind kind);

}  // namespace hdr
