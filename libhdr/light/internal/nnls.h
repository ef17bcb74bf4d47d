#pragma once
#include "libhdr/core/vec.h"

namespace hdr {

struct NonNegative {
  Eigen::VectorXd x;
  Eigen::VectorXd variance;  ///< diagonal of the inverse of the normal matrix of what is above 0; 0 for what is not
};

/// The least |A x - b|^2 with x >= 0, from A'A (which must be positive definite) and A'b: [Lawson74] chapter 23.
NonNegative non_negative_least_squares(const Eigen::MatrixXd& normal, const Eigen::VectorXd& right);

}  // namespace hdr
