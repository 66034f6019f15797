// The small dense normal equations of the pose stage on the host: J^T J delta = -J^T F (paper, "Data Parallel
// GPU Optimization", "Pose Estimation"). The paper takes a QR decomposition; a pivoted Cholesky one, L D L^T, gives the
// same step of a damped system ten times as fast.
#pragma once

#include <Eigen/Core>

namespace livecap {

// What came of a solve. Anything but kOk means that the prediction was kept.
enum class SolveStatus {
  kOk,
  kNoObservations,  // nothing in the frame constrains the unknowns
  kRankDeficient,   // the damped system still has no unique solution
  kNotFinite,       // NaN or infinity in the system or in the solution
};

// Pivots below this share of the largest count as zero, in the system scaled to unit diagonal.
inline constexpr double kRankThreshold = 1e-12;

struct DenseSolution {
  SolveStatus status = SolveStatus::kOk;
  Eigen::VectorXd delta;  // [n] zero unless status is kOk
};

// Solves (A + diag(damping)) delta = -g by L D L^T with pivots on the system scaled to unit diagonal.
// An unknown without a diagonal entry (no residual depends on it and no damping) gets delta 0.
// A [n,n] symmetric, g [n] = J^T F, damping [n] >= 0.
DenseSolution solve_normal_equations(const Eigen::MatrixXd& A, const Eigen::VectorXd& g,
                                     const Eigen::VectorXd& damping);

}  // namespace livecap
