#pragma once
// What the code of a point is worth to the fit of a curve.
#include <Eigen/Core>
#include <vector>

#include "libhdr/response/noise.h"
#include "libhdr/response/response.h"

namespace hdr {

/// The hat of [Debevec97] eq. 4: 1 in the middle; a little is left at the ends.
double hat_weight(double code, double max_code);

/// w(Z), by which the residual g(Z_ij) - ln E_i - ln H_j of [Debevec97] eq. 3 is multiplied. Positive; linear between
/// the codes at which a response has its samples.
class CodeWeights {
 public:
  /// The hat, before anything is known of the noise.
  static CodeWeights hat(int bits);

  /// 1 / the standard deviation of g(Z) that `noise` gives the channel, through the slope of its curve, to the mean of
  /// a small window: shot and read noise, rounding, compression, and a little for the light itself. Scaled so that the
  /// squares of the weights of `codes` (NaN: none) have the hat's sum: a smoothness then means the same with either.
  static CodeWeights from_noise(const Response& response, int channel, const NoiseModel& noise,
                                const Eigen::MatrixXd& codes);

  double at(double code) const;

 private:
  CodeWeights(int bits, std::vector<double> samples);

  double samples_a_code_;
  std::vector<double> samples_;  ///< evenly spaced in the code, the last one at the largest
};

}  // namespace hdr
