#pragma once
// What calibration looks at: points of the scene, and the code each of them had in each shot.
#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "libhdr/core/photo.h"
#include "libhdr/core/vec.h"
#include "libhdr/response/internal/sample_places.h"

namespace hdr {

/// codes[channel](i, j) is the code of point i in shot j, a mean over a small window and so fractional; NaN where it is
/// black, clipped or outside the frame. Each channel has its own points.
struct Observations {
  int bits = 8;
  Eigen::VectorXd ln_exposure;  ///< ln H_j
  std::array<Eigen::MatrixXd, 3> codes;
  /// Codes up to here no longer fall with the exposure: scans of film, and cameras that keep a pedestal, never reach 0.
  std::array<double, 3> black_level{0, 0, 0};
};

/// Codes that can be trusted to follow the light: above the noise of black, below what clipping touches.
struct UsableCodes {
  double lowest, highest;
  bool contains(double code) const { return code >= lowest && code <= highest; }
};
UsableCodes usable_codes(int bits, bool lossy);

/// At most about `points` scene points a channel, spread over the picture and over its codes, in the smoothest places:
/// there misregistration and JPEG's ringing do least. `onlookers` look at each shot while it is decoded.
Observations sample_points(const Bracket& bracket, const std::vector<Mat3>& ref_from_photo, int points,
                           std::span<internal::CodesAtPlaces* const> onlookers = {});

/// Points that are ranks instead of places: the q-quantiles of each shot's codes belong to the same radiance, since the
/// response keeps order [Grossberg03]. Needs no registration.
Observations match_quantiles(const Bracket& bracket);

/// Drops the points that fewer than two shots of different exposure saw.
Eigen::MatrixXd rows_seen_twice(const Eigen::MatrixXd& codes, const Eigen::VectorXd& ln_exposure);

}  // namespace hdr
