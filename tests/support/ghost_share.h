#pragma once
// What --deghost does to a bracket, seen from its map: how many pixels it changes by more than the map's own deviation.
#include <cmath>

#include "libhdr/align/align.h"
#include "libhdr/merge/merge.h"
#include "libhdr/response/calibrate.h"

namespace hdr::test {

struct GhostShare {
  double touched = 0;        ///< share of the pixels that are not what they were
  double beyond_sigma = 0;   ///< share that changed in a channel by more than the standard deviation stated without
  Image<std::uint8_t> mask;  ///< Ghosts::mask
};

/// As `hdr merge` does it.
inline GhostShare ghost_share(const Bracket& bracket) {
  const Alignment alignment = align(bracket, provisional_response(bracket));
  const Calibration calibration = calibrate_debevec_malik(bracket, alignment.ref_from_photo());
  MergeOptions options;
  options.noise_estimate = calibration.noise;
  options.uncertainty = true;
  const Merged plain = merge(bracket, alignment, calibration.response, options);
  options.deghost = true;
  Merged clean = merge(bracket, alignment, calibration.response, options);
  GhostShare share;
  for (int y = 0; y < plain.map.rgb.height(); ++y) {
    for (int x = 0; x < plain.map.rgb.width(); ++x) {
      bool touched = false, beyond = false;
      for (int c = 0; c < 3; ++c) {
        const float change = std::abs(clean.map.rgb(x, y, c) - plain.map.rgb(x, y, c));
        touched = touched || change > 0;
        beyond = beyond || change > plain.map.stddev(x, y, c);
      }
      share.touched += touched;
      share.beyond_sigma += beyond;
    }
  }
  const double pixels = static_cast<double>(plain.map.rgb.width()) * plain.map.rgb.height();
  share.touched /= pixels;
  share.beyond_sigma /= pixels;
  share.mask = std::move(clean.ghosts.mask);
  return share;
}

}  // namespace hdr::test
