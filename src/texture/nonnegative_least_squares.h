// Least squares whose unknowns are powers of lamps, lengths, ...: none of them negative.
#pragma once

#include <Eigen/Core>

namespace livecap {

// The x >= 0 that minimises x^T normal_matrix x / 2 - right^T x: active sets, one more unknown free in every step
// (Lawson and Hanson, "Solving Least Squares Problems", 1974, chapter 23). normal_matrix: [n,n], symmetric, positive
// definite.
Eigen::VectorXd solve_nonnegative(const Eigen::MatrixXd& normal_matrix, const Eigen::VectorXd& right);

}  // namespace livecap
