#pragma once
// How much a shot is worth.
#include <optional>
#include <vector>

#include "libhdr/response/noise.h"
#include "libhdr/response/response.h"

namespace hdr {

/// Codes from here up may stand for any amount of light.
int first_clipped_code(int bits, bool lossy);

/// The zero of light of one channel: codes up to black_code mean none, and exp(g) is `offset` too large.
struct BlackPoint {
  int black_code = 0;
  double offset = 0;
};

/// The black code of the response, or `black_level` where that is above it; the offset is exp(g(black_level)).
BlackPoint black_point(const Response& response, int channel, std::optional<double> black_level);

/// Light of each code 0 .. 2^bits - 1: exp(g) less the offset; half of the first code's lower threshold for black ones.
std::vector<double> light_table(const Response& response, int channel, const BlackPoint& black);

/// Variance of exp(g(Z)) of a channel when the light, in units of exp(g) with its offset, is `exposure`: shot and read
/// noise, and 1/12 + code_noise^2 codes through the slope of the curve there.
double exposure_variance(const Response& response, int channel, const NoiseModel& noise, double exposure);

/// The weight of a lossy code, kHat: for each code, light / variance of light, up to a factor common to all codes; 0
/// for black and for clipped codes. A shot of exposure H measures radiance light / H with H times this weight.
///
/// The relative deviation is 1 % / hat, so the relative weight, hat^2, falls to zero at both ends faster than the hat
/// of [Debevec97] eq. 4: what JPEG does to codes near the ends (chroma subsampling, ringing) is worse than their
/// rounding. The sensor's noise adds to it.
///
/// Why not the weight of maximum likelihood, H^2 / variance, nor that of the relative error, light^2 / variance? They
/// agree where all shots see one radiance, H ~ light. Where they do not, the first believes the darker shot (blur and
/// misregistration beside bright things), the second the brighter one (read noise that lifts black a little in a short
/// exposure is a great radiance). The geometric mean of the two treats both alike, as a mean of logarithms would.
std::vector<float> hat_weights(const Response& response, int channel, bool lossy, const NoiseModel& noise,
                               const BlackPoint& black);

}  // namespace hdr
