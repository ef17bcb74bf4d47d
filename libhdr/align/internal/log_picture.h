#pragma once
// What registration compares: ln of scene radiance, ln(exposure / H), with its variance. In these units the shots of a
// bracket differ by their motion, by noise and by which pixels are usable, and by nothing else.
#include <limits>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/photo_samples.h"
#include "libhdr/response/response.h"

namespace hdr::internal {

inline constexpr float kUnusable = std::numeric_limits<float>::infinity();

/// One channel each. Where nothing is known, variance is kUnusable (its weight is then zero) and ln is 0.
struct LogPicture {
  Image<float> ln;
  Image<float> variance;
  int cell = 1;  ///< photograph pixels along the side of one of its pixels

  bool usable(int x, int y) const { return variance(x, y) < kUnusable; }
};

/// A code nearer to either end of 255 than this is noise and black level, or clipping smeared by compression.
inline constexpr double kDarkestCode = 5.0 / 255;
inline constexpr double kBrightestCode = 250.0 / 255;

/// Share of the photograph's pixels with all channels between those codes, which run to `max_code`.
double usable_share(const PhotoSamples& samples, int max_code);

/// Codes of `bits` bits -> (exposure, variance) of one channel, weighted by its share in luminance.
class Linearizer {
 public:
  Linearizer(const Response& response, int bits, bool lossy);

  struct Level {
    float exposure = 0;
    float variance = kUnusable;
  };
  const Level* table(int channel) const { return table_[channel].data(); }

 private:
  std::vector<Level> table_[3];
};

/// Averages square cells of a photograph of exposure `h`; each cell takes every `step`-th pixel in both directions. A
/// cell is usable when all its samples are.
LogPicture log_picture(const Codes& codes, double h, const Linearizer& linearizer, int cell, int step);

/// Of windows of PhotoSamples::kTileSide pixels a side that lie side by side, each pixel for itself, with an unusable
/// frame around each window: a small picture that shows small motions.
LogPicture tile_picture(const Codes& tiles, double h, const Linearizer& linearizer);

/// Half the size: 2x2 averages weighted by precision; usable when at least half of the four are.
LogPicture halved(const LogPicture& fine);

/// Binomial 3x3 smoothing in both; usable where a neighbourhood of `reach` pixels around is usable before smoothing.
LogPicture smoothed(const LogPicture& sharp, int reach);

}  // namespace hdr::internal
