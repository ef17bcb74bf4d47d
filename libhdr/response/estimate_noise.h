#pragma once
// The camera's noise, measured from the bracket itself: shots of one scene repeat each other but for noise.
#include <vector>

#include "libhdr/core/photo.h"
#include "libhdr/core/vec.h"
#include "libhdr/response/noise.h"
#include "libhdr/response/response.h"

namespace hdr {

struct NoiseEstimate {
  Noise noise;
  /// Share of the residuals that lie beyond four deviations of the model. Noise alone gives 1 in 15 000; things that
  /// moved, edges that are not registered and the grain of scanned film give per cents.
  double outliers = 0;
};

/// Photon transfer [Janesick07] without a dark frame: the variance of X_short - X_long H_short / H_long, robustly, as a
/// function of the level, is that of the noise model; full well and read noise (and, for lossy files, code_noise)
/// follow from it. Where the shots say little (one shot, no overlap) the model stays near its defaults.
/// `ref_from_photo[k]` maps pixels (centres at integers) of shot k to the common grid; empty means registered. Shots
/// that are `left_out` (empty: none), because they could not be registered, say nothing. `exposures` of the shots, up
/// to a factor, take the place of their relative_exposure() where the times are known better (empty: they are not).
NoiseEstimate estimate_noise(const Bracket& bracket, const std::vector<Mat3>& ref_from_photo, const Response& response,
                             const std::vector<bool>& left_out = {}, const std::vector<double>& exposures = {});

}  // namespace hdr
