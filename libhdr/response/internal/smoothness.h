#pragma once
// The smoothness of g, from the data.
#include <Eigen/Core>
#include <array>

#include "libhdr/response/internal/knots.h"

namespace hdr {

/// Cross-validation: g is fitted to two thirds of the points and judged by the residuals of the last third, for each
/// smoothness of a grid. Of those within one standard error of the best, or within a tenth of its mean square, the
/// smoothest wins [Hastie09, 7.10]: held-out points cannot see a curve's error that is periodic in the step of a
/// uniform bracket, and a little systematic error in dark codes would otherwise buy such waves. An empty channel does
/// not vote.
double choose_smoothness(const Knots& knots, const std::array<Eigen::MatrixXd, 3>& codes,
                         const Eigen::VectorXd& ln_exposure);

}  // namespace hdr
