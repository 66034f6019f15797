#include "pose/leg_exchange.h"

#include <span>
#include <utility>

#include "pose/targets.h"

namespace livecap {
namespace {

using Sides = std::pair<Keypoint, Keypoint>;  // left, right

constexpr Sides kLeg[] = {{kLeftKnee, kRightKnee}, {kLeftAnkle, kRightAnkle}, {kLeftToe, kRightToe}};

// Share of the hips' distance that must lie across the picture.
constexpr double kLeastAcross = 0.5;

}  // namespace

std::vector<KeypointDetections> exchanged_legs(const Actor& actor, const Camera& camera, const Pose& predicted,
                                               const KeypointDetections& detected) {
  std::vector<KeypointDetections> alternatives;
  if (actor.keypoints[kLeftHip].bone < 0 || actor.keypoints[kRightHip].bone < 0) return alternatives;
  const auto positions = keypoint_positions(actor, forward_kinematics(actor.skeleton, predicted));
  const Eigen::Vector3d hips = positions[kLeftHip] - positions[kRightHip];
  if (!(hips.head<2>().norm() >= kLeastAcross * hips.norm())) return alternatives;
  const auto distance_px = [&](Keypoint model, Keypoint seen) {
    const Eigen::Vector3d& p = positions[model];
    if (actor.keypoints[model].bone < 0 || !(p.z() > 0)) return 0.0;
    return (project_px(camera, p) - Eigen::Vector2d(detected[seen].x_px, detected[seen].y_px)).norm();
  };
  for (size_t from : {0, 1}) {
    double as_named = 0, exchanged = 0;
    KeypointDetections alternative = detected;
    for (const auto& [left, right] : std::span(kLeg).subspan(from)) {
      as_named += distance_px(left, left) + distance_px(right, right);
      exchanged += distance_px(left, right) + distance_px(right, left);
      std::swap(alternative[left], alternative[right]);
    }
    if (exchanged < as_named) alternatives.push_back(alternative);
  }
  return alternatives;
}

}  // namespace livecap
