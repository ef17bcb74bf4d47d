#pragma once
// [Grossberg04] The responses of real cameras lie close to a mean curve and a few directions: f(E) = f0(E) + sum_n c_n
// h_n(E). A curve so told has few unknowns, and none that is periodic in the step of a uniform bracket.
#include <Eigen/Core>
#include <array>

#include "libhdr/response/internal/emor_basis.h"
#include "libhdr/response/internal/observations.h"

namespace hdr {

/// One response of the family. Exposures run from 0 to 1 = saturation, values from 0 to 1 = code / largest code.
/// Between the published samples the curve is a cubic spline in x = ln(E + 1/1023); where the sum falls it is held, so
/// that the curve rises everywhere.
class EmorCurve {
 public:
  /// `coefficients`: c_1, c_2, ..., at most kEmorComponents; those left out are 0.
  explicit EmorCurve(const Eigen::VectorXd& coefficients);

  int components() const { return static_cast<int>(coefficients_.size()); }
  double value(double exposure) const;     ///< f(E; c), E in [0, 1]
  double ln_exposure(double value) const;  ///< g = ln f^-1(value; c), value in (0, 1]; finite
  double slope(double ln_exposure) const;  ///< df/d ln E, positive
  /// dg/dc_n = -h_n(E) / (df/d ln E) at this ln E, for each component.
  Eigen::VectorXd gradient(double ln_exposure) const;
  /// df/dx of the sum before it was held, at `count` places evenly spaced in x; negative is not a camera's.
  Eigen::VectorXd slopes(int count) const;
  /// d slopes / dc, count x kEmorComponents.
  static Eigen::MatrixXd slopes_of_components(int count);

 private:
  Eigen::VectorXd coefficients_;
  Eigen::VectorXd nodes_, bends_;  ///< of the sum: values and second derivatives at the samples
  Eigen::VectorXd held_;           ///< the rising curve on a dense grid of x
};

/// One channel's response. `g` and `stddev` stand at the codes that were asked for; g(2^(bits-1)) = 0.
struct EmorChannel {
  Eigen::VectorXd coefficients;  ///< empty where the channel had no points
  Eigen::VectorXd g;             ///< natural logs
  /// What g may be wrong by, ln: the noise of the fit, what one component more would change, what no member of the
  /// family can tell, and the grain of the published samples, 1/1023 of saturation: it leaves the darkest codes, those
  /// of less than .003 of saturation, unknown by .2 and more.
  Eigen::VectorXd stddev;
  double rms = 0;  ///< of g(Z_ij) - ln E_i - ln H_j, weighted by how reliable each code is, ln
};

struct EmorFit {
  std::array<EmorChannel, 3> channels;
  int components = 0;  ///< as many in each channel
  bool converged = false;
};

/// The member of the family that explains the points best: weighted by what a code can tell, robustly, with as few
/// components as predict held-out points as well as more do. `codes`: where g is wanted, in (0, 2^bits - 1].
EmorFit fit_emor(const Observations& observations, const Eigen::VectorXd& codes);

}  // namespace hdr
