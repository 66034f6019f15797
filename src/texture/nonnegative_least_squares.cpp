#include "texture/nonnegative_least_squares.h"

#include <Eigen/Cholesky>
#include <vector>

namespace livecap {

namespace {

constexpr double kNoGain = 1e-10;  // of the largest entry of `right`: a gradient that is none

Eigen::VectorXd solve_free(const Eigen::MatrixXd& normal_matrix, const Eigen::VectorXd& right,
                           const std::vector<int>& free) {
  const Eigen::MatrixXd part = normal_matrix(free, free);
  return part.ldlt().solve(right(free).eval());
}

}  // namespace

Eigen::VectorXd solve_nonnegative(const Eigen::MatrixXd& normal_matrix, const Eigen::VectorXd& right) {
  const int n = static_cast<int>(right.size());
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  const double least_gain = kNoGain * right.cwiseAbs().maxCoeff();
  std::vector<int> free;
  std::vector<char> is_free(n, 0);
  // Every unknown usually comes in once; rounding may let two take turns.
  for (int step = 0; step < 3 * n; ++step) {
    const Eigen::VectorXd gain = right - normal_matrix * x;
    int best = -1;
    for (int i = 0; i < n; ++i)
      if (!is_free[i] && gain[i] > least_gain && (best < 0 || gain[i] > gain[best])) best = i;
    if (best < 0) break;
    is_free[best] = 1;
    free.push_back(best);
    while (true) {
      const Eigen::VectorXd wanted = solve_free(normal_matrix, right, free);
      // As far towards it as none becomes negative; the one that then is zero stays there.
      double share = 1;
      int first_zero = -1;
      for (size_t k = 0; k < free.size(); ++k) {
        if (wanted[k] > 0) continue;
        const double its = x[free[k]] / (x[free[k]] - wanted[k]);
        if (first_zero < 0 || its < share) share = its, first_zero = free[k];
      }
      for (size_t k = 0; k < free.size(); ++k) x[free[k]] += share * (wanted[k] - x[free[k]]);
      if (first_zero < 0) break;
      x[first_zero] = 0;
      is_free[first_zero] = 0;
      std::erase(free, first_zero);
      if (free.empty()) break;
    }
  }
  return x;
}

}  // namespace livecap
