#include "solve/dense_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>

#include "support/tolerances.h"

namespace livecap {
namespace {

// J of a badly scaled problem: columns differ by 1e4.
Eigen::MatrixXd example_jacobian(int rows, int columns) {
  std::srand(3);
  Eigen::MatrixXd J = Eigen::MatrixXd::Random(rows, columns);
  for (int k = 0; k < columns; ++k) J.col(k) *= k % 2 == 0 ? 1.0 : 1e4;
  return J;
}

TEST(DenseSolver, SolvesLikeLeastSquares) {
  const Eigen::MatrixXd J = example_jacobian(60, 12);
  const Eigen::VectorXd F = Eigen::VectorXd::Random(60);
  const DenseSolution solution =
      solve_normal_equations(J.transpose() * J, J.transpose() * F, Eigen::VectorXd::Zero(12));
  const Eigen::VectorXd expected = J.colPivHouseholderQr().solve(-F);
  EXPECT_EQ(solution.status, SolveStatus::kOk);
  EXPECT_LT((J * (solution.delta - expected)).norm(), test::kDoubleExact * F.norm());
}

TEST(DenseSolver, DampingIsAddedToTheDiagonal) {
  const Eigen::MatrixXd J = example_jacobian(60, 12);
  const Eigen::VectorXd F = Eigen::VectorXd::Random(60);
  const Eigen::VectorXd damping = Eigen::VectorXd::LinSpaced(12, 0.1, 2);
  Eigen::MatrixXd A = J.transpose() * J;
  const DenseSolution solution = solve_normal_equations(A, J.transpose() * F, damping);
  A.diagonal() += damping;
  EXPECT_LT((A * solution.delta + J.transpose() * F).norm(), test::kDoubleExact * (J.transpose() * F).norm());
}

TEST(DenseSolver, UnknownsOutsideEveryResidualStay) {
  Eigen::MatrixXd J = example_jacobian(60, 12);
  J.col(5).setZero();
  const Eigen::VectorXd F = Eigen::VectorXd::Random(60);
  const DenseSolution solution =
      solve_normal_equations(J.transpose() * J, J.transpose() * F, Eigen::VectorXd::Zero(12));
  EXPECT_EQ(solution.status, SolveStatus::kOk);
  EXPECT_EQ(solution.delta[5], 0);
  EXPECT_GT(solution.delta.norm(), 0);
}

TEST(DenseSolver, DependentUnknownsAreReportedAndDampingResolvesThem) {
  Eigen::MatrixXd J = example_jacobian(60, 12);
  J.col(7) = J.col(3);
  const Eigen::VectorXd F = Eigen::VectorXd::Random(60);
  const Eigen::MatrixXd A = J.transpose() * J;
  const Eigen::VectorXd g = J.transpose() * F;
  const DenseSolution bare = solve_normal_equations(A, g, Eigen::VectorXd::Zero(12));
  EXPECT_EQ(bare.status, SolveStatus::kRankDeficient);
  EXPECT_EQ(bare.delta.norm(), 0);
  EXPECT_EQ(solve_normal_equations(A, g, 1e-6 * A.diagonal()).status, SolveStatus::kOk);
}

TEST(DenseSolver, NanIsReportedWithoutAStep) {
  for (double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Eigen::MatrixXd A = Eigen::MatrixXd::Identity(4, 4);
    Eigen::VectorXd g = Eigen::VectorXd::Ones(4);
    A(1, 2) = bad;
    EXPECT_EQ(solve_normal_equations(A, g, Eigen::VectorXd::Zero(4)).status, SolveStatus::kNotFinite);
    A(1, 2) = 0;
    g[3] = bad;
    const DenseSolution solution = solve_normal_equations(A, g, Eigen::VectorXd::Zero(4));
    EXPECT_EQ(solution.status, SolveStatus::kNotFinite);
    EXPECT_EQ(solution.delta.norm(), 0);
  }
}

}  // namespace
}  // namespace livecap
