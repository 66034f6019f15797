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

std::span<const Sides> from_knees_or_ankles(bool from_knees) {
  return std::span(kLeg).subspan(from_knees ? 0 : 1);
}

}  // namespace

KeypointDetections with_legs_exchanged(const KeypointDetections& detected, bool from_knees) {
  KeypointDetections exchanged = detected;
  for (const auto& [left, right] : from_knees_or_ankles(from_knees)) std::swap(exchanged[left], exchanged[right]);
  return exchanged;
}

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
  for (bool from_knees : {true, false}) {
    double as_named = 0, exchanged = 0;
    for (const auto& [left, right] : from_knees_or_ankles(from_knees)) {
      as_named += distance_px(left, left) + distance_px(right, right);
      exchanged += distance_px(left, right) + distance_px(right, left);
    }
    if (exchanged < as_named) alternatives.push_back(with_legs_exchanged(detected, from_knees));
  }
  return alternatives;
}

}  // namespace livecap
