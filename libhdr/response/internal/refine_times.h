#pragma once
// Exposure times, from the pictures.
#include <Eigen/Core>
#include <array>

#include "libhdr/response/internal/knots.h"
#include "libhdr/response/internal/observations.h"

namespace hdr {

/// ln of the true power of two (in thirds) of every time that is a label of a camera's 1/3-stop scale: 1/60 s is 2^-6
/// s. The input itself when a time is no such label. Natural logs.
Eigen::VectorXd snapped_ln_times(const Eigen::VectorXd& seconds);

struct RefinedTimes {
  Eigen::VectorXd correction;  ///< d_j, to be added to ln H_j
  double rms = 0;              ///< of the residuals with it
  double count = 0;            ///< residuals
  double prior = 0;            ///< sum (d_j / the deviation of a shutter)^2: how unlikely the correction was beforehand
  bool converged = false;
};

/// Minimises [Debevec97] eq. 3 over g of all channels, ln E and d_j, where ln H_j + d_j takes the place of ln H_j. What
/// the data cannot tell is fixed: the mean of d_j (a common factor) and its slope against ln H_j (g and d may share
/// any: g = 0 with d = -ln H would fit perfectly), both weighted by the points of each shot, are zero. Each d_j stays
/// within a quarter of a stop, and costs what an error of a shutter of 3 % is worth. `noise` is the rms of the
/// residuals that noise alone explains.
RefinedTimes refine_times(const Knots& knots, const Observations& seen, double smoothness, double noise);

}  // namespace hdr
