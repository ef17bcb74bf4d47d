#pragma once
// Normal equations, and what to make of those that determine too little.
#include <Eigen/Core>

namespace hdr {

/// X of matrix X = right, for a symmetric matrix of information: of no negative eigenvalue but for rounding, and not
/// all zero. By Cholesky's blocked factorisation; where that fails some directions are determined by nothing, and are
/// taken to be held as weakly as rounding can tell from not at all: the solution stays along the others, and a variance
/// (right the identity) is vast, but a number.
Eigen::MatrixXd solve_definite(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right);

}  // namespace hdr
