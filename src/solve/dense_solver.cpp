#include "solve/dense_solver.h"

#include <Eigen/Cholesky>

namespace livecap {

DenseSolution solve_normal_equations(const Eigen::MatrixXd& A, const Eigen::VectorXd& g,
                                     const Eigen::VectorXd& damping) {
  const Eigen::Index n = g.size();
  DenseSolution solution;
  solution.delta = Eigen::VectorXd::Zero(n);
  if (!A.allFinite() || !g.allFinite() || !damping.allFinite()) {
    solution.status = SolveStatus::kNotFinite;
    return solution;
  }
  Eigen::MatrixXd scaled = A;
  scaled.diagonal() += damping;
  // Millimetres and radians differ by orders of magnitude: with a unit diagonal one rank threshold fits both.
  Eigen::VectorXd scale(n);
  for (Eigen::Index i = 0; i < n; ++i) scale[i] = scaled(i, i) > 0 ? 1 / std::sqrt(scaled(i, i)) : 0;
  scaled = scale.asDiagonal() * scaled * scale.asDiagonal();
  for (Eigen::Index i = 0; i < n; ++i) {
    if (scale[i] == 0) scaled(i, i) = 1;
  }

  const Eigen::LDLT<Eigen::MatrixXd> ldlt(scaled);
  const Eigen::VectorXd pivots = ldlt.vectorD();
  if (!(pivots.minCoeff() > kRankThreshold * pivots.maxCoeff())) {
    solution.status = SolveStatus::kRankDeficient;
    return solution;
  }
  const Eigen::VectorXd delta = scale.asDiagonal() * ldlt.solve(-(scale.asDiagonal() * g));
  if (!delta.allFinite()) {
    solution.status = SolveStatus::kNotFinite;
    return solution;
  }
  solution.delta = delta;
  return solution;
}

}  // namespace livecap
