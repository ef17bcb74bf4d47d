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
#include "libhdr/merge/deghost.h"
#include "libhdr/merge/drift.h"
#include "libhdr/response/estimate_noise.h"
#include "libhdr/response/noise.h"
#include "libhdr/response/response.h"

namespace hdr {

/// How much each shot is believed (weight.h).
///   kVariance  maximum likelihood under the noise model: the inverse of the variance at the level that the other shots
///              predict, so that no weight follows the noise of the code that it weighs
///   kHat       a function of the code alone that distrusts both ends, where JPEG smears and rings
///   kAuto      kHat when a shot is lossy, or when the shots differ by more than noise (more than 1 % outliers: things
///              that moved, registration, film grain); else kVariance
enum class WeightKind { kAuto, kHat, kVariance };

struct MergeOptions {
  WeightKind weight = WeightKind::kAuto;
  std::optional<Noise> noise;  ///< absent: estimated from the bracket (response/estimate_noise.h) where it is needed
  std::optional<NoiseEstimate> noise_estimate;  ///< of this bracket, where calibrating made one: saves making it again
  bool deghost = false;                         ///< leaves shots out where things moved (deghost.h)
  bool drift = false;                           ///< exposures are corrected by the shots' gains (drift.h)
  bool uncertainty = false;                     ///< standard deviation and flags of every pixel
  std::optional<double> exposure_unit;          ///< absent: that of the bracket's middle shot
  std::optional<double> black_level;  ///< code that means no light, subtracted in linear light; absent: the response's
  View<const float> flat;  ///< flat field, 3 channels, the map's size: what a uniform scene gave; empty: none
};

struct MergedFrame {
  bool used = false;
  std::string skipped;  ///< why the shot was left out: "all black", "registered within 3.0 px only"
  std::string limited;  ///< where alone it is used, and why; empty: wherever it says something
  FrameGain gain;       ///< when drift was asked for
};

/// The unit: radiance 1 gives the middle code at relative exposure `exposure_unit`, that of the bracket's middle shot.
/// So maps of long brackets stay within half floats, and radiance / exposure_unit compares maps of one camera.
/// `clipped` and `dark` count pixels of which a channel is clipped (black) in every shot: their value is a bound. The
/// radiance of such a clipped pixel is never below what saturates the shortest shot.
struct MergeSummary {
  std::vector<MergedFrame> frames;  ///< in the order of Bracket::shots
  std::int64_t clipped = 0;
  std::int64_t dark = 0;
  double exposure_unit = 1;
  double stops = 0;          ///< log2 of the 99.9 % over the 0.1 % quantile of positive luminance
  Ghosts ghosts;             ///< when deghost was asked for
  double skipped_tiles = 0;  ///< share of the tiles of all shots that had nothing to add, and were not looked at
};

struct Merged : MergeSummary {
  RadianceMap map;            ///< with stddev when uncertainty was asked for
  Image<std::uint8_t> flags;  ///< PixelFlag of each pixel; empty unless uncertainty was asked for
};

/// Merges the rows of all shots as they pass by (rows_of(photo): codes need not be in memory) and puts the map into
/// `sink` in bands: memory follows the band, not the number of shots. Radiance is exp(g(Z)) / H in the unit above, less
/// the black level, over the flat field (flat / its maximum, a channel at a time). Never NaN, infinite or negative.
///
/// The standard deviation is that of the noise model at the merged radiance: rounding, shot and read noise, and for
/// lossy files what compression adds. Of a pixel that is a bound (PixelFlag) it is the value itself: 100 %.
///
/// Shots that are registered within more than a pixel (FrameAlignment::residual_px) would blur what the others show:
/// longer ones than the reference are left out, shorter ones measure what clips in all others, and only that.
///
/// Throws Error for shots of another depth than the response, exposures that are not positive, and a flat field of
/// another size or with a value that is not positive.
MergeSummary merge_rows(const Bracket& bracket, const Alignment& alignment, const Response& response,
                        const MergeOptions& options, MapSink& sink);

/// The same into memory.
Merged merge(const Bracket& bracket, const Alignment& alignment, const Response& response,
             const MergeOptions& options = {});

}  // namespace hdr
