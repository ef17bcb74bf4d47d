#pragma once
// How much brighter one frame is than another, when the camera's response is not known: what of it matters is learnt on
// the way, from frames whose exposures are known.
#include <Eigen/Core>
#include <optional>

#include "capture/appearance.h"

namespace hdr {

/// Equal shares of two frames of one scene are the same light, whatever moved a little: their quantiles pair codes with
/// codes without looking at pixels [Grossberg03]. With g(x) the log exposure of x = ln of a code over the range, each
/// pair says g(x_b) - g(x_a) = ln ratio. g is piecewise linear with a Gaussian prior that holds the responses that
/// cameras have: a slope of 1.9 +- 0.6 (1: linear light, 2.2: a gamma curve), which changes slowly. So even the first
/// ratio can be told from "it did not move", and each ratio that is learnt makes the next one certain: gamma and
/// exposure ratio cannot be told apart by one step, but equal steps must look equal.
class BrightnessModel {
 public:
  /// Of frames with these codes. Linear ones need no learning.
  explicit BrightnessModel(const UsableCodes& usable);

  struct Ratio {
    double ln_ratio = 0;   ///< of exposure, b over a
    double deviation = 0;  ///< one standard deviation
  };
  /// nullopt when the frames have no codes in common that tell: all black or all clipped in one of them.
  std::optional<Ratio> ratio(const Appearance& a, const Appearance& b) const;

  /// The exposure of b over that of a is known. Frames without codes in common teach nothing.
  void learn(const Appearance& a, const Appearance& b, double ln_ratio);

  /// g(code), up to a constant; code in (black, white].
  double ln_exposure(double code) const;
  const UsableCodes& usable() const { return usable_; }

 private:
  struct Pairs;
  std::optional<Pairs> pairs(const Appearance& a, const Appearance& b) const;
  double x_of(double code) const;
  Eigen::VectorXd weights_of(double code) const;
  void solve();

  UsableCodes usable_;
  double darkest_;             ///< code below which rounding is all there is
  double first_x_, spacing_;   ///< of the knots
  Eigen::MatrixXd precision_;  ///< normal equations of the knots' values
  Eigen::VectorXd right_;
  Eigen::VectorXd values_;
  Eigen::MatrixXd covariance_;
};

}  // namespace hdr
