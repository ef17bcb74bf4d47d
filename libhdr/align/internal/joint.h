#pragma once
// All pairs of a bracket reconciled: the place of each shot that explains the measured motions best.
#include <string>
#include <vector>

#include "libhdr/align/internal/motion.h"
#include "libhdr/align/internal/pairs.h"

namespace hdr::internal {

/// A shot's place on the reference, before decisions.
struct Place {
  Mat3 photo_from_ref = Mat3::Identity();
  double error_px = 0;  ///< root mean square over the picture, one standard deviation
  double inliers = 0;   ///< mean share of agreeing tiles of its trusted pairs; of the others where it has none
  std::string trouble;  ///< why it could not be measured (it then moves with its neighbour); else empty
};

/// The model that all pairs together support, each as sure as its tiles and the loops it closes say.
MotionModel common_model(const MotionFrame& frame, const std::vector<MeasuredPair>& pairs);

/// Least squares over the motions of all shots but the reference, each pair weighted by its covariance, with a robust
/// loss for pairs that contradict the others. `shots` places in the order of `used`; `reference` is one of them.
std::vector<Place> reconcile(const MotionFrame& frame, int shots, int reference,
                             const std::vector<MeasuredPair>& pairs);

}  // namespace hdr::internal
