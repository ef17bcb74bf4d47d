#pragma once
// The smoothness of g, from the data.
#include <Eigen/Core>
#include <array>

#include "libhdr/response/internal/knots.h"

namespace hdr {

/// Cross-validation: g is fitted to two thirds of the points and judged by the residuals of the last third, for each
/// smoothness of a grid. Of those within one standard error of the best, the smoothest [Hastie09, 7.10]. An empty
/// channel does not vote.
double choose_smoothness(const Knots& knots, const std::array<Eigen::MatrixXd, 3>& codes,
                         const Eigen::VectorXd& ln_exposure, double outlier_scale);

}  // namespace hdr
