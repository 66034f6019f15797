#include "pose/initialize.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "pose/targets.h"

namespace livecap {
namespace {

constexpr int kTorso[] = {kPelvis, kLeftHip, kRightHip, kNeck, kLeftShoulder, kRightShoulder};
constexpr int kScoutSweeps = 8;
constexpr int kFinalSweeps = 20;
constexpr int kDescentStarts = 12;
constexpr double kSmallestTurnRad = 1e-3;
constexpr double kNearestRootMm = 300;

// camera_from_root by Kabsch's method, or nullopt when the points do not span a plane.
std::optional<Eigen::Matrix3d> align_torso(const std::array<Eigen::Vector3d, kKeypointCount>& model,
                                           const Keypoints3d& detected) {
  Eigen::Vector3d model_mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d detected_mean = Eigen::Vector3d::Zero();
  double total = 0;
  int n_known = 0;
  for (int k : kTorso) {
    if (detected[k].confidence > 0) ++n_known;
    total += detected[k].confidence;
    model_mean += detected[k].confidence * model[k];
    detected_mean += detected[k].confidence * detected[k].position_mm;
  }
  if (n_known < 3 || !(total > 0)) return std::nullopt;
  model_mean /= total;
  detected_mean /= total;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (int k : kTorso)
    covariance += detected[k].confidence / total * (detected[k].position_mm - detected_mean) *
                  (model[k] - model_mean).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (!(svd.singularValues()[1] > 1e-3 * svd.singularValues()[0])) return std::nullopt;
  Eigen::Vector3d sign(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
  return svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
}

std::array<Eigen::Vector3d, kKeypointCount> rested_keypoints(const Actor& actor) {
  return keypoint_positions(actor, forward_kinematics(actor.skeleton, rest_pose(actor.skeleton)));
}

// The angle in [min, max] that maximises c cos(x - now) + s sin(x - now).
double best_angle(double c, double s, double now, double min, double max) {
  const double turn = std::atan2(s, c);
  double best = now;
  double best_value = -std::numeric_limits<double>::infinity();
  const auto consider = [&](double x) {
    const double value = c * std::cos(x - now) + s * std::sin(x - now);
    if (x < min || x > max || value <= best_value) return;
    best = x;
    best_value = value;
  };
  for (int whole_turns : {-1, 0, 1}) consider(now + turn + 2 * std::numbers::pi * whole_turns);
  consider(min);
  consider(max);
  return best;
}

// The 3D keypoints' squared distances to their targets, summed per limb (see Limbs).
std::vector<double> limb_errors(const Actor& actor, const Keypoints3d& targets, const std::vector<int>& limbs,
                                const Pose& pose) {
  const auto positions = keypoint_positions(actor, forward_kinematics(actor.skeleton, pose));
  std::vector<double> errors(actor.skeleton.n_bones(), 0.0);
  for (int i = 0; i < kKeypointCount; ++i) {
    if (actor.keypoints[i].bone < 0) continue;
    const Eigen::Vector3d error = positions[i] - positions[kPelvis] - targets[i].position_mm;
    errors[limbs[actor.keypoints[i].bone]] += targets[i].confidence * error.squaredNorm();
  }
  return errors;
}

// What each bone is part of. The trunk is the root and what carries the neck; it is turned as a whole (align_torso),
// its bend is left to the steps that follow. A limb is what hangs on it, named by its first bone: limbs do not
// influence each other.
struct Limbs {
  std::vector<int> of_bone;
  std::vector<char> is_trunk;
};

Limbs limbs_of(const Skeleton& skeleton) {
  Limbs limbs{std::vector<int>(skeleton.n_bones(), 0), std::vector<char>(skeleton.n_bones(), 0)};
  limbs.is_trunk[0] = 1;
  for (int b = skeleton.bone_index("neck"); b > 0; b = skeleton.bones[b].parent)
    limbs.is_trunk[skeleton.bones[b].parent] = 1;
  for (int b = 1; b < skeleton.n_bones(); ++b) {
    const int parent = skeleton.bones[b].parent;
    limbs.of_bone[b] = limbs.is_trunk[b] || limbs.is_trunk[parent] ? b : limbs.of_bone[parent];
  }
  return limbs;
}

// Cyclic coordinate descent: turns one joint after the other to the angle at which the keypoints it moves are nearest
// to their targets.
void descend_angles(const Actor& actor, const Keypoints3d& targets, const Limbs& limbs, int n_sweeps, Pose& pose) {
  const Skeleton& skeleton = actor.skeleton;
  const std::vector<uint64_t> masks = dofs_moving_bones(skeleton);
  for (int sweep = 0; sweep < n_sweeps; ++sweep) {
    double largest_turn = 0;
    for (int k = 0; k < skeleton.n_dofs(); ++k) {
      if (limbs.is_trunk[skeleton.dofs[k].bone]) continue;
      const PosedSkeleton posed = forward_kinematics(skeleton, pose);
      const auto positions = keypoint_positions(actor, posed);
      // Pelvis on pelvis: the detections are relative to it.
      const Eigen::Vector3d shift = positions[kPelvis];
      const Eigen::Vector3d& axis = posed.dof_axis[k];
      double c = 0;
      double s = 0;
      for (int i = 0; i < kKeypointCount; ++i) {
        const KeypointAnchor& anchor = actor.keypoints[i];
        if (anchor.bone < 0 || !(masks[anchor.bone] >> k & 1)) continue;
        const Eigen::Vector3d from = positions[i] - posed.dof_origin_mm[k];
        const Eigen::Vector3d to = targets[i].position_mm + shift - posed.dof_origin_mm[k];
        c += targets[i].confidence * to.dot(from - axis * axis.dot(from));
        s += targets[i].confidence * to.dot(axis.cross(from));
      }
      if (c == 0 && s == 0) continue;
      const Dof& dof = skeleton.dofs[k];
      const double angle = best_angle(c, s, pose.angles_rad[k], dof.min_rad, dof.max_rad);
      largest_turn = std::max(largest_turn, std::abs(angle - pose.angles_rad[k]));
      pose.angles_rad[k] = angle;
    }
    if (largest_turn < kSmallestTurnRad) break;
  }
}

// Joint limits make local minima (an arm twisted the wrong way round), so the descent starts from several places and
// each limb keeps its best: the rest pose, then points spread evenly over the joint ranges.
void find_angles(const Actor& actor, const Keypoints3d& targets, Pose& pose) {
  const Skeleton& skeleton = actor.skeleton;
  const Limbs limbs = limbs_of(skeleton);
  Pose best = pose;
  std::vector<double> best_errors;
  for (int start = 0; start < kDescentStarts; ++start) {
    Pose candidate = pose;
    for (int k = 0; k < skeleton.n_dofs() && start > 0; ++k) {
      if (limbs.is_trunk[skeleton.dofs[k].bone]) continue;
      // Additive recurrence by the golden ratio's powers: evenly spread without a random generator.
      const double share = 0.15 + 0.7 * std::fmod(0.5 + start * std::pow(1 / 1.2207440846, 1 + k % 4), 1.0);
      candidate.angles_rad[k] =
          skeleton.dofs[k].min_rad + share * (skeleton.dofs[k].max_rad - skeleton.dofs[k].min_rad);
    }
    descend_angles(actor, targets, limbs, kScoutSweeps, candidate);
    const std::vector<double> errors = limb_errors(actor, targets, limbs.of_bone, candidate);
    if (best_errors.empty()) best_errors.assign(errors.size(), std::numeric_limits<double>::infinity());
    for (int k = 0; k < skeleton.n_dofs(); ++k) {
      const int limb = limbs.of_bone[skeleton.dofs[k].bone];
      if (errors[limb] < best_errors[limb]) best.angles_rad[k] = candidate.angles_rad[k];
    }
    for (size_t limb = 0; limb < errors.size(); ++limb) best_errors[limb] = std::min(best_errors[limb], errors[limb]);
  }
  pose = best;
  descend_angles(actor, targets, limbs, kFinalSweeps, pose);
}

// Translation that best projects root-relative points onto the 2D detections: u (z + t_z) = f_x (x + t_x) + c_x (z +
// t_z) is linear in t. nullopt when the points are too few or would lie behind the camera.
std::optional<Eigen::Vector3d> translation_from_2d(const std::array<Eigen::Vector3d, kKeypointCount>& points,
                                                   const Camera& camera, const KeypointTargets& targets) {
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  int n_known = 0;
  const auto add_row = [&](const Eigen::Vector3d& row, double value, double weight) {
    A += weight * row * row.transpose();
    b += weight * value * row;
  };
  for (int k = 0; k < kKeypointCount; ++k) {
    const double weight = targets[k].weight_2d;
    if (!(weight > 0)) continue;
    ++n_known;
    const Eigen::Vector3d& p = points[k];
    const double u = targets[k].position_px.x() - camera.cx;
    const double v = targets[k].position_px.y() - camera.cy;
    add_row({camera.fx, 0, -u}, u * p.z() - camera.fx * p.x(), weight);
    add_row({0, camera.fy, -v}, v * p.z() - camera.fy * p.y(), weight);
  }
  if (n_known < 3) return std::nullopt;
  const Eigen::ColPivHouseholderQR<Eigen::Matrix3d> qr(A);
  if (qr.rank() < 3) return std::nullopt;
  const Eigen::Vector3d t = qr.solve(b);
  if (!t.allFinite() || t.z() < kNearestRootMm) return std::nullopt;
  return t;
}

}  // namespace

Pose predict_pose(const Skeleton& skeleton, const Pose* before_previous, const Pose& previous,
                  const PoseOptions& options) {
  if (!before_previous) return previous;
  const Eigen::Vector3d turn =
      vector_from_rotation(previous.root_rotation * before_previous->root_rotation.transpose());
  const Eigen::Vector3d move = previous.root_translation_mm - before_previous->root_translation_mm;
  Eigen::VectorXd delta(6 + skeleton.n_dofs());
  const double turn_bound = options.max_predicted_turn_rad;
  delta.head<3>() = turn * std::min(1.0, turn_bound / std::max(turn.norm(), 1e-12));
  delta.segment<3>(3) = move * std::min(1.0, options.max_predicted_move_mm / std::max(move.norm(), 1e-12));
  for (int k = 0; k < skeleton.n_dofs(); ++k) {
    const double now = previous.angles_rad[k];
    const double step = std::clamp(now - before_previous->angles_rad[k], -turn_bound, turn_bound);
    const double low = std::min(now, skeleton.dofs[k].min_rad);
    const double high = std::max(now, skeleton.dofs[k].max_rad);
    delta[6 + k] = std::clamp(now + step, low, high) - now;
  }
  if (!delta.allFinite()) return previous;
  return add_increment(previous, delta);
}

std::optional<Eigen::Matrix3d> torso_rotation(const Actor& actor, const Detections& detections,
                                              const PoseOptions& options) {
  if (!detections.person) return std::nullopt;
  return align_torso(rested_keypoints(actor), detected_points(actor, detections, options));
}

std::optional<Eigen::Matrix3d> torso_rotation(const Actor& actor,
                                              const std::array<Eigen::Vector3d, kKeypointCount>& positions) {
  Keypoints3d points;
  for (int k : kTorso)
    if (actor.keypoints[k].bone >= 0) points[k] = {positions[k], 1};
  return align_torso(rested_keypoints(actor), points);
}

std::optional<Pose> initialize_pose(const Actor& actor, const Camera& camera, const Detections& detections,
                                    const PoseOptions& options) {
  const std::optional<Eigen::Matrix3d> rotation = torso_rotation(actor, detections, options);
  if (!rotation) return std::nullopt;
  Pose pose = rest_pose(actor.skeleton);
  pose.root_translation_mm.setZero();
  pose.root_rotation = *rotation;
  find_angles(actor, detected_points(actor, detections, options), pose);

  const auto points = keypoint_positions(actor, forward_kinematics(actor.skeleton, pose));
  const auto translation = translation_from_2d(points, camera, make_targets(actor, detections, nullptr, options));
  if (!translation) return std::nullopt;
  pose.root_translation_mm = *translation;
  return pose;
}

}  // namespace livecap
