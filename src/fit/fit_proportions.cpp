#include "fit/fit_proportions.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "actor/posed_vertices.h"
#include "pose/person_height.h"
#include "pose/pose_options.h"
#include "pose/targets.h"

namespace livecap {

namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kSteps = 8;
constexpr double kKeypointShare = 0.012;    // standard deviation of a keypoint, of the person's height in the picture
constexpr double kSilhouetteShare = 0.004;  // of a point of the outline
constexpr double kOutlinePoints = 120;      // as how many independent points an outline counts
constexpr double kLengthPrior = 0.12;       // standard deviation of a length, relative, in each frame
constexpr double kGirthPrior = 0.2;         // of a girth
constexpr double kShoulderPrior = 0.05;     // of the shoulders' width, which trades against the arms' length
// Of thigh against shank and upper arm against forearm: people differ little in them, and a network that sees knees
// and elbows too high or too low does so in every frame.
constexpr double kRatioPrior = 0.03;
constexpr double kAnglePriorRad = 0.15;     // of a joint angle around that of the frame's own solution
constexpr double kRotationPriorRad = 0.08;  // of the root
constexpr double kHuberSigmas = 2;
constexpr double kLimitRad = 0.03;     // standard deviation of an angle beyond its limit
constexpr double kLargestStep = 0.08;  // of a proportion's logarithm
constexpr double kEnough = 5e-4;
constexpr double kAngleStep = 1e-4, kMoveStep = 0.5, kScaleStep = 1e-4;  // of the differences: rad, mm, 1

// One frame's residuals, whitened, as a function of proportions and pose.
class FrameProblem {
 public:
  FrameProblem(const Actor& actor, const Reshaper& reshaper, const Camera& camera, const FitFrame& frame)
      : actor_(actor), reshaper_(reshaper), camera_(camera), frame_(frame), start_(frame.pose) {
    const double height = keypoints_height_px(frame.detections);
    keypoint_px_ = std::max(1.0, kKeypointShare * height);
    silhouette_px_ = std::max(1.0, kSilhouetteShare * height);
    const auto lambda = default_keypoint_2d_weights();
    for (int k = 0; k < kKeypointCount; ++k) {
      const double confidence = frame.detections.keypoints[k].confidence;
      weights_[k] = actor.keypoints[k].bone >= 0 && confidence > 0.3 ? std::sqrt(lambda[k] * confidence) : 0;
    }
  }

  void set_outline(std::vector<int32_t> outline) { outline_ = std::move(outline); }

  VectorXd residuals(const Shape& shape, const Pose& pose) const {
    const PosedSkeleton posed = forward_kinematics(shape.skeleton, pose);
    const std::vector<float> quats = bone_dual_quats(posed);
    const int n_angles = static_cast<int>(pose.angles_rad.size());
    VectorXd r(2 * kKeypointCount + static_cast<int>(outline_.size()) + 2 * n_angles + 3);
    int row = 0;
    for (int k = 0; k < kKeypointCount; ++k) {
      Vector2d error = Vector2d::Zero();
      if (weights_[k] > 0) {
        const KeypointAnchor& anchor = actor_.keypoints[k];
        const Vector3d p =
            posed.camera_from_rest[anchor.bone] * reshaper_.attached(shape, anchor.bone, anchor.rest_position_mm);
        const KeypointDetection& seen = frame_.detections.keypoints[k];
        error = weights_[k] / keypoint_px_ * (project_px(camera_, p) - Vector2d(seen.x_px, seen.y_px));
      }
      r.segment<2>(row) = error;
      row += 2;
    }
    const double share = std::sqrt(std::min(1.0, kOutlinePoints / std::max<size_t>(outline_.size(), 1)));
    for (int vertex : outline_) {
      const Vector3d p = posed_point(quats, actor_.skin, vertex, reshaper_.vertex(shape, vertex));
      const Vector2d pixel = project_px(camera_, p);
      r[row++] = share / silhouette_px_ * distance_at(frame_.silhouette, pixel.x(), pixel.y());
    }
    for (int k = 0; k < n_angles; ++k) {
      const Dof& dof = shape.skeleton.dofs[k];
      const double angle = pose.angles_rad[k];
      r[row++] = (angle - start_.angles_rad[k]) / kAnglePriorRad;
      r[row++] = (std::max(0.0, angle - dof.max_rad) - std::max(0.0, dof.min_rad - angle)) / kLimitRad;
    }
    r.segment<3>(row) = vector_from_rotation(pose.root_rotation * start_.root_rotation.transpose()) / kRotationPriorRad;
    return r;
  }

  // Factors that make large residuals of the picture count linearly (Huber); the priors keep theirs.
  VectorXd robust_factors(const VectorXd& r) const {
    VectorXd factors = VectorXd::Ones(r.size());
    for (int k = 0; k < kKeypointCount; ++k) {
      const double size = r.segment<2>(2 * k).norm();
      if (size > kHuberSigmas) factors.segment<2>(2 * k).setConstant(std::sqrt(kHuberSigmas / size));
    }
    const double share = std::sqrt(std::min(1.0, kOutlinePoints / std::max<size_t>(outline_.size(), 1)));
    for (size_t i = 0; i < outline_.size(); ++i) {
      const double size = std::abs(r[2 * kKeypointCount + i]) / share;
      if (size > kHuberSigmas) factors[2 * kKeypointCount + i] = std::sqrt(kHuberSigmas / size);
    }
    return factors;
  }

 private:
  const Actor& actor_;
  const Reshaper& reshaper_;
  const Camera& camera_;
  const FitFrame& frame_;
  Pose start_;
  double keypoint_px_, silhouette_px_;
  std::array<double, kKeypointCount> weights_{};
  std::vector<int32_t> outline_;
};

// The linearised frame with the pose eliminated.
struct Reduced {
  MatrixXd pose_factor;  // [pose x pose] lower Cholesky factor is taken when needed
  MatrixXd mixed;        // [pose x proportions]
  VectorXd pose_right;   // -Jp^T r
};

std::vector<float> displacement_of(const Actor& actor, const Reshaper& reshaper, const Shape& shape) {
  std::vector<float> displacement(actor.mesh.positions.size());
  for (int i = 0; i < actor.n_vertices(); ++i) {
    const Vector3d p = reshaper.vertex(shape, i);
    for (int k = 0; k < 3; ++k)
      displacement[3 * static_cast<size_t>(i) + k] =
          static_cast<float>(p[k]) - actor.mesh.positions[3 * static_cast<size_t>(i) + k];
  }
  return displacement;
}

}  // namespace

Proportions fit_proportions(FramePoser& poser, const Actor& actor, const Camera& camera,
                            std::vector<FitFrame>& frames) {
  const Reshaper reshaper(actor);
  std::vector<FrameProblem> problems;
  std::vector<FitFrame*> used;
  for (FitFrame& frame : frames) {
    if (!frame.posed) continue;
    problems.emplace_back(actor, reshaper, camera, frame);
    used.push_back(&frame);
  }
  Proportions proportions = Proportions::Zero(), prior;
  for (int k = 0; k < kProportionCount; ++k) {
    const bool girth =
        k == kTrunkGirth || k == kUpperArmGirth || k == kForearmGirth || k == kThighGirth || k == kShankGirth;
    prior[k] = 1 / (girth ? kGirthPrior : kLengthPrior);
  }
  prior[kShoulderWidth] = 1 / kShoulderPrior;
  Eigen::Matrix<double, kProportionCount, kProportionCount> prior_matrix = prior.cwiseAbs2().asDiagonal();
  for (const auto& [a, b] : {std::pair{kThighLength, kShankLength}, std::pair{kUpperArmLength, kForearmLength}}) {
    const Proportions ratio = (Proportions::Unit(a) - Proportions::Unit(b)) / kRatioPrior;
    prior_matrix += ratio * ratio.transpose();
  }
  const int n_pose = 6 + actor.skeleton.n_dofs();
  for (int step = 0; step < kSteps && !used.empty(); ++step) {
    const Shape shape = reshaper.shape(proportions);
    const std::vector<float> displacement = displacement_of(actor, reshaper, shape);
    std::vector<Shape> nudged;
    for (int k = 0; k < kProportionCount; ++k)
      nudged.push_back(reshaper.shape(proportions + kScaleStep * Proportions::Unit(k)));
    MatrixXd matrix = MatrixXd::Zero(kProportionCount, kProportionCount);
    VectorXd right = VectorXd::Zero(kProportionCount);
    std::vector<Reduced> reduced;
    for (size_t f = 0; f < used.size(); ++f) {
      const Pose& pose = used[f]->pose;
      problems[f].set_outline(poser.outline(shape.skeleton, pose, displacement));
      const VectorXd r = problems[f].residuals(shape, pose);
      const VectorXd factors = problems[f].robust_factors(r);
      MatrixXd by_pose(r.size(), n_pose), by_shape(r.size(), kProportionCount);
      for (int k = 0; k < n_pose; ++k) {
        VectorXd delta = VectorXd::Zero(n_pose);
        delta[k] = k >= 3 && k < 6 ? kMoveStep : kAngleStep;
        by_pose.col(k) = factors.cwiseProduct(problems[f].residuals(shape, add_increment(pose, delta)) - r) / delta[k];
      }
      for (int k = 0; k < kProportionCount; ++k)
        by_shape.col(k) = factors.cwiseProduct(problems[f].residuals(nudged[k], pose) - r) / kScaleStep;
      const VectorXd weighted = factors.cwiseProduct(r);
      Reduced frame{by_pose.transpose() * by_pose, by_pose.transpose() * by_shape, -by_pose.transpose() * weighted};
      frame.pose_factor.diagonal() *= 1 + 1e-6;
      frame.pose_factor.diagonal().array() += 1e-9;
      const Eigen::LDLT<MatrixXd> solve(frame.pose_factor);
      matrix += by_shape.transpose() * by_shape - frame.mixed.transpose() * solve.solve(frame.mixed);
      right += -by_shape.transpose() * weighted - frame.mixed.transpose() * solve.solve(frame.pose_right);
      matrix += prior_matrix;
      right -= prior_matrix * proportions;
      reduced.push_back(std::move(frame));
    }
    Proportions change = matrix.ldlt().solve(right);
    if (!change.allFinite()) break;
    const double largest = change.cwiseAbs().maxCoeff();
    if (largest > kLargestStep) change *= kLargestStep / largest;
    proportions += change;
    for (size_t f = 0; f < used.size(); ++f) {
      VectorXd delta =
          Eigen::LDLT<MatrixXd>(reduced[f].pose_factor).solve(reduced[f].pose_right - reduced[f].mixed * change);
      if (!delta.allFinite()) continue;
      const double turn = std::max(delta.head<3>().cwiseAbs().maxCoeff(), delta.tail(n_pose - 6).cwiseAbs().maxCoeff());
      if (turn > 0.4) delta *= 0.4 / turn;
      used[f]->pose = add_increment(used[f]->pose, delta);
    }
    if (largest < kEnough) break;
  }
  return proportions;
}

}  // namespace livecap
