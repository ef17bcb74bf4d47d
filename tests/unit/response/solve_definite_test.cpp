#include "libhdr/response/internal/solve_definite.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

namespace hdr {
namespace {

TEST(SolveDefinite, IsTheInverseWhereThereIsOne) {
  Eigen::MatrixXd matrix(3, 3);
  matrix << 4, 1, 0, 1, 3, -1, 0, -1, 2;
  const Eigen::MatrixXd inverse = solve_definite(matrix, Eigen::MatrixXd::Identity(3, 3));
  EXPECT_LT((inverse - matrix.inverse()).cwiseAbs().maxCoeff(), 1e-14);
}

// x + y is known to be 2 with unit variance, x - y is not known at all.
TEST(SolveDefinite, WhatNothingDeterminesIsVastAndTheRestStays) {
  Eigen::MatrixXd information(2, 2);
  information << 1, 1, 1, 1;
  const Eigen::MatrixXd solution = solve_definite(information, Eigen::Vector2d(2, 2));
  EXPECT_NEAR(solution.sum(), 2, 1e-12);
  const Eigen::MatrixXd covariance = solve_definite(information, Eigen::MatrixXd::Identity(2, 2));
  ASSERT_TRUE(covariance.allFinite());
  EXPECT_GT(covariance(0, 0), 1e12);
  EXPECT_GT(Eigen::Vector2d(1, -1).dot(covariance * Eigen::Vector2d(1, -1)), 1e12);
}

}  // namespace
}  // namespace hdr
