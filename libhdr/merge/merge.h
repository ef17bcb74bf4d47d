#pragma once
// Bracket + response -> radiance map, on the reference shot's grid.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libhdr/align/align.h"
#include "libhdr/core/photo.h"
#include "libhdr/core/radiance.h"
#include "libhdr/core/rows.h"
#include "libhdr/response/noise.h"
#include "libhdr/response/response.h"

namespace hdr {

enum class WeightKind { kAuto, kHat, kVariance };

struct MergeOptions {
  WeightKind weight = WeightKind::kAuto;
  std::optional<Noise> noise;           ///< absent: estimated from the bracket (response/estimate_noise.h)
  bool uncertainty = false;             ///< standard deviation and flags of every pixel
  std::optional<double> exposure_unit;  ///< absent: that of the bracket's middle shot
  std::optional<double> black_level;    ///< code that means no light, subtracted in linear light; absent: the response's
  View<const float> flat;               ///< flat field, 3 channels, the map's size: what a uniform scene gave; empty: none
};

struct MergedFrame {
  bool used = false;
  std::string skipped;  ///< why the shot was left out: "all black", "registered within 3.0 px only"
};

/// The unit: radiance 1 gives the middle code at relative exposure `exposure_unit`, that of the bracket's middle shot.
/// So maps of long brackets stay within half floats, and radiance / exposure_unit compares maps of one camera.
/// `clipped` and `dark` count pixels of which a channel is clipped (black) in every shot: their value is a bound. The
/// radiance of such a clipped pixel is never below what saturates the shortest shot.
struct Merged {
  RadianceMap map;
  std::vector<MergedFrame> frames;  ///< in the order of Bracket::shots
  std::int64_t clipped = 0;
  std::int64_t dark = 0;
  double exposure_unit = 1;
  double stops = 0;  ///< log2 of the 99.9 % over the 0.1 % quantile of positive luminance
};

/// Weighted mean of linear radiance exp(g(Z)) / H, in the unit above. Weights fall to zero at both ends faster than the
/// hat; a clipped code counts only in the shortest exposure, a black one only in the longest. Never NaN, infinite or
/// negative.
Merged merge(const Bracket& bracket, const Alignment& alignment, const Response& response,
             const MergeOptions& options = {});

}  // namespace hdr
