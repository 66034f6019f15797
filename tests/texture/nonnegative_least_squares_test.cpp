// The least squares of lamps against every choice of which unknowns are zero.
#include "texture/nonnegative_least_squares.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "support/tolerances.h"

namespace livecap {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Problem {
  MatrixXd normal_matrix;
  VectorXd right;
};

Problem random_problem(int n, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const MatrixXd rows = MatrixXd::NullaryExpr(n + 3, n, [&] { return normal(random); });
  const VectorXd target = VectorXd::NullaryExpr(n + 3, [&] { return normal(random); });
  return {rows.transpose() * rows, rows.transpose() * target};
}

double cost(const Problem& problem, const VectorXd& x) {
  return 0.5 * x.dot(problem.normal_matrix * x) - problem.right.dot(x);
}

// The best of all 2^n sets of free unknowns whose solution is not negative.
VectorXd by_trying_all(const Problem& problem) {
  const int n = static_cast<int>(problem.right.size());
  VectorXd best = VectorXd::Zero(n);
  for (int set = 1; set < 1 << n; ++set) {
    std::vector<int> free;
    for (int i = 0; i < n; ++i)
      if (set >> i & 1) free.push_back(i);
    const MatrixXd part = problem.normal_matrix(free, free);
    const VectorXd right = problem.right(free);
    VectorXd x = VectorXd::Zero(n);
    x(free) = part.fullPivLu().solve(right);
    if (x.minCoeff() >= 0 && cost(problem, x) < cost(problem, best)) best = x;
  }
  return best;
}

TEST(NonnegativeLeastSquares, IsTheBestOfAllSetsOfZeros) {
  int n_zeros = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    const Problem problem = random_problem(8, seed);
    const VectorXd x = solve_nonnegative(problem.normal_matrix, problem.right), best = by_trying_all(problem);
    EXPECT_LT((x - best).norm(), test::kSolvedExactly * (1 + best.norm())) << "seed " << seed;
    n_zeros += static_cast<int>((x.array() == 0).count());
  }
  EXPECT_GT(n_zeros, 80);  // of 320: the bound counts
}

// Karush, Kuhn and Tucker: no gradient where free, none that would help where zero.
TEST(NonnegativeLeastSquares, IsOptimalForManyUnknowns) {
  const Problem problem = random_problem(120, 7);
  const VectorXd x = solve_nonnegative(problem.normal_matrix, problem.right);
  const VectorXd gain = problem.right - problem.normal_matrix * x;
  const double small = test::kSolvedExactly * problem.right.cwiseAbs().maxCoeff();
  for (int i = 0; i < x.size(); ++i) {
    EXPECT_GE(x[i], 0);
    EXPECT_LT(gain[i], small);
    if (x[i] > 0) EXPECT_GT(gain[i], -small);
  }
}

TEST(NonnegativeLeastSquares, IsZeroWhereNothingHelps) {
  const Problem problem = random_problem(5, 3);
  EXPECT_TRUE((solve_nonnegative(problem.normal_matrix, VectorXd::Constant(5, -1)).array() == 0).all());
}

}  // namespace
}  // namespace livecap
