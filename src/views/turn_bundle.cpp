#include "views/turn_bundle.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/rotation_vector.h"

namespace livecap {

namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Matrix23 = Eigen::Matrix<double, 2, 3>;
using Matrix63 = Eigen::Matrix<double, 6, 3>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr double kNearestMm = 100;
constexpr double kWeakPoint = 1e-12;  // of a point's normal matrix: seen along one line, it stays in place
constexpr double kMeanSigma = 1e-4;   // rad, of the deviations' mean
constexpr double kConverged = 1e-4;   // relative gain of a step
constexpr double kAngleSigma = 10;    // rad, from where it starts; only the common zero of all angles needs it

Matrix3d cross(const Vector3d& v) {
  Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Vector3d vector_of(const Eigen::Quaterniond& q) {
  const Eigen::AngleAxisd a(q);
  return a.angle() * a.axis();
}

// Cauchy: cost log(1 + s) / 2 of s = |r|^2, weight 1 / (1 + s).
class Bundle {
 public:
  Bundle(const Camera& camera, const std::vector<TurnObservation>& observations, const TurnBundleOptions& options,
         const Turn& start)
      : camera_(camera), observations_(observations), options_(options), start_rad_(start.angle_rad) {}

  double cost(const Turn& turn) const {
    const auto poses = poses_of(turn);
    double sum = 0;
    for (const TurnObservation& seen : observations_) {
      const Vector3d p = poses[seen.view] * turn.points_mm[seen.point];
      if (!(p.z() > kNearestMm)) return std::numeric_limits<double>::infinity();
      sum += std::log1p(residual(p, seen).squaredNorm()) / 2;
    }
    for (size_t i = 0; i < start_rad_.size(); ++i)
      sum += std::pow((turn.angle_rad[i] - start_rad_[i]) / kAngleSigma, 2) / 2;
    if (options_.deviate) sum += mean_deviation(turn).squaredNorm() / (2 * kMeanSigma * kMeanSigma);
    if (options_.deviate)
      for (const TurnDeviation& d : turn.deviation)
        sum += (vector_of(d.rotation).squaredNorm() / std::pow(options_.sway_rad, 2) +
                d.shift_mm.squaredNorm() / std::pow(options_.shift_mm, 2)) /
               2;
    return sum;
  }

  // The damped Gauss-Newton step from here.
  Turn step(const Turn& turn, double damping) const {
    const auto poses = poses_of(turn);
    const int n_views = static_cast<int>(poses.size()), n_points = static_cast<int>(turn.points_mm.size());
    MatrixXd h = MatrixXd::Zero(6 * n_views, 6 * n_views);
    VectorXd g = VectorXd::Zero(6 * n_views);
    std::vector<Matrix3d> point_h(n_points, Matrix3d::Zero());
    std::vector<Vector3d> point_g(n_points, Vector3d::Zero());
    std::vector<std::vector<std::pair<int, Matrix63>>> coupling(n_points);
    for (const TurnObservation& seen : observations_) {
      const Vector3d turned = poses[seen.view].linear() * turn.points_mm[seen.point];
      const Vector3d p = turned + poses[seen.view].translation();
      const Eigen::Vector2d r = residual(p, seen);
      const Matrix23 project = pixel_by_point(camera_.fx, camera_.fy, p) / seen.sigma_px;
      Eigen::Matrix<double, 2, 6> by_pose;
      by_pose << project * -cross(turned), project;
      const Matrix23 by_point = project * poses[seen.view].linear();
      const double weight = 1 / (1 + r.squaredNorm());
      h.block<6, 6>(6 * seen.view, 6 * seen.view) += weight * by_pose.transpose() * by_pose;
      g.segment<6>(6 * seen.view) += weight * by_pose.transpose() * r;
      point_h[seen.point] += weight * by_point.transpose() * by_point;
      point_g[seen.point] += weight * by_point.transpose() * r;
      coupling[seen.point].emplace_back(seen.view, weight * by_pose.transpose() * by_point);
    }
    std::vector<Matrix3d> inverse(n_points);
    for (int k = 0; k < n_points; ++k) {
      Matrix3d damped = point_h[k];
      damped.diagonal() += damping * damped.diagonal() + Vector3d::Constant(kWeakPoint + 1e-9 * damped.trace());
      inverse[k] = damped.inverse();
      for (const auto& [i, a] : coupling[k]) {
        const Matrix63 ai = a * inverse[k];
        g.segment<6>(6 * i) -= ai * point_g[k];
        for (const auto& [j, b] : coupling[k]) h.block<6, 6>(6 * i, 6 * j) -= ai * b.transpose();
      }
    }
    const MatrixXd chain = chain_of(turn);
    MatrixXd a = chain.transpose() * h * chain;
    VectorXd b = chain.transpose() * g;
    add_priors(turn, a, b);
    a.diagonal() += damping * a.diagonal().cwiseAbs() + VectorXd::Constant(a.rows(), 1e-9);
    const VectorXd d = -a.ldlt().solve(b);
    const VectorXd twist = chain * d;
    Turn next = apply(turn, d);
    for (int k = 0; k < n_points; ++k) {
      Vector3d gradient = point_g[k];
      for (const auto& [i, c] : coupling[k]) gradient += c.transpose() * twist.segment<6>(6 * i);
      next.points_mm[k] -= inverse[k] * gradient;
    }
    return next;
  }

 private:
  // Shared: tilt about camera x and z, shift of the axis along camera x; then an angle a view, then 6 a view.
  static constexpr int kShared = 3;

  static std::vector<Eigen::Isometry3d> poses_of(const Turn& turn) {
    std::vector<Eigen::Isometry3d> poses;
    for (size_t i = 0; i < turn.angle_rad.size(); ++i) poses.push_back(turn.camera_from_body(static_cast<int>(i)));
    return poses;
  }

  Eigen::Vector2d residual(const Vector3d& p, const TurnObservation& seen) const {
    return (Eigen::Vector2d(camera_.fx * p.x() / p.z() + camera_.cx, camera_.fy * p.y() / p.z() + camera_.cy) -
            seen.pixel) /
           seen.sigma_px;
  }

  // How the poses' twists (rotation, translation) follow the unknowns.
  MatrixXd chain_of(const Turn& turn) const {
    const int n = static_cast<int>(turn.angle_rad.size());
    MatrixXd chain = MatrixXd::Zero(6 * n, kShared + n + (options_.deviate ? 6 * n : 0));
    for (int i = 0; i < n; ++i) {
      const Matrix3d after = turn.deviation[i].rotation.toRotationMatrix();
      if (!options_.keep_axis) {
        chain.block<3, 1>(6 * i, 0) = after.col(0);
        chain.block<3, 1>(6 * i, 1) = after.col(2);
      }
      chain(6 * i + 3, 2) = 1;
      chain.block<3, 1>(6 * i, kShared + i) = after * (turn.axis * Vector3d::UnitY());
      if (options_.deviate) chain.block<6, 6>(6 * i, kShared + n + 6 * i).setIdentity();
    }
    return chain;
  }

  // rad, camera axes.
  static Vector3d mean_deviation(const Turn& turn) {
    Vector3d sum = Vector3d::Zero();
    for (const TurnDeviation& d : turn.deviation) sum += vector_of(d.rotation);
    return sum / static_cast<double>(turn.deviation.size());
  }

  void add_priors(const Turn& turn, MatrixXd& a, VectorXd& b) const {
    const int n = static_cast<int>(turn.angle_rad.size());
    for (int i = 0; i < n; ++i) {
      a(kShared + i, kShared + i) += 1 / (kAngleSigma * kAngleSigma);
      b[kShared + i] += (turn.angle_rad[i] - start_rad_[i]) / (kAngleSigma * kAngleSigma);
      if (!options_.deviate) continue;
      Vector6 value, stiffness;
      value << vector_of(turn.deviation[i].rotation), turn.deviation[i].shift_mm;
      stiffness << Vector3d::Constant(1 / std::pow(options_.sway_rad, 2)),
          Vector3d::Constant(1 / std::pow(options_.shift_mm, 2));
      const int at = kShared + n + 6 * i;
      a.diagonal().segment<6>(at) += stiffness;
      // No deviation in common: that would be another axis.
      const double share = 1 / (n * kMeanSigma * kMeanSigma);
      b.segment<3>(at) += share * mean_deviation(turn);
      for (int j = 0; j < n; ++j) a.block<3, 3>(at, kShared + n + 6 * j).diagonal() += Vector3d::Constant(share / n);
      b.segment<6>(at) += stiffness.cwiseProduct(value);
    }
  }

  Turn apply(const Turn& turn, const VectorXd& d) const {
    Turn next = turn;
    next.axis = (rotation_of(Vector3d(d[0], 0, d[1])) * turn.axis).normalized();
    next.center_mm.x() += d[2];
    const int n = static_cast<int>(turn.angle_rad.size());
    for (int i = 0; i < n; ++i) {
      next.angle_rad[i] += d[kShared + i];
      if (!options_.deviate) continue;
      const auto own = d.segment<6>(kShared + n + 6 * i);
      next.deviation[i].rotation = (rotation_of(own.head<3>()) * turn.deviation[i].rotation).normalized();
      next.deviation[i].shift_mm += own.tail<3>();
    }
    return next;
  }

  const Camera& camera_;
  const std::vector<TurnObservation>& observations_;
  const TurnBundleOptions& options_;
  std::vector<double> start_rad_;
};

}  // namespace

Eigen::Isometry3d Turn::camera_from_body(int view) const {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() =
      (deviation[view].rotation * axis * Eigen::AngleAxisd(angle_rad[view], Vector3d::UnitY())).toRotationMatrix();
  pose.translation() = center_mm + deviation[view].shift_mm;
  return pose;
}

double Turn::error_px(const Camera& camera, const TurnObservation& seen) const {
  const Vector3d p = camera_from_body(seen.view) * points_mm[seen.point];
  if (!(p.z() > kNearestMm)) return std::numeric_limits<double>::infinity();
  return std::hypot(camera.fx * p.x() / p.z() + camera.cx - seen.pixel.x(),
                    camera.fy * p.y() / p.z() + camera.cy - seen.pixel.y());
}

double solve_turn(const Camera& camera, const std::vector<TurnObservation>& observations,
                  const TurnBundleOptions& options, Turn& turn) {
  const Bundle bundle(camera, observations, options, turn);
  double cost = bundle.cost(turn), damping = 1e-3;
  for (int i = 0; i < options.max_iterations && damping < 1e8; ++i) {
    Turn next = bundle.step(turn, damping);
    const double next_cost = bundle.cost(next);
    if (!(next_cost < cost)) {
      damping *= 8;
      continue;
    }
    const bool done = cost - next_cost < kConverged * cost;
    turn = std::move(next);
    cost = next_cost;
    damping = std::max(1e-9, damping / 4);
    if (done) break;
  }
  return cost;
}

}  // namespace livecap
