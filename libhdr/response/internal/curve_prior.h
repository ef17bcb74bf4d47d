#pragma once
// What g is expected to be where the shots leave it open.
#include <Eigen/Core>
#include <array>

#include "libhdr/response/internal/knots.h"
#include "libhdr/response/internal/observations.h"

namespace hdr {

/// The curve of Grossberg and Nayar's family that explains the points best, at the knots, for each channel; empty where
/// a channel has no points. Smoothness then judges how g departs from it. Below the codes that the published basis
/// resolves (emor.h) it goes on straight in u, as smoothness alone would have it.
std::array<Eigen::VectorXd, 3> emor_prior(const Knots& knots, const Observations& seen);

/// Are all exposures multiples of one step of 1.5 EV or more apart? They leave g open to any function of that period
/// [Grossberg03]: g(Z) + p(g(Z)) explains the same codes. The step in EV; 0 when they are not.
double ambiguous_step(const Eigen::VectorXd& ln_exposure);

}  // namespace hdr
