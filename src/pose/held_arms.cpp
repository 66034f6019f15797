#include "pose/held_arms.h"

#include <cmath>

#include "pose/arm_points.h"

namespace livecap {
namespace {

double rest_energy(const std::vector<RestAngle>& rest, const Pose& pose) {
  double sum = 0;
  for (size_t k = 0; k < rest.size(); ++k) sum += rest[k].weight * std::pow(pose.angles_rad[k] - rest[k].rad, 2);
  return sum;
}

}  // namespace

std::vector<RestAngle> rest_angles(const Actor& actor, const Detections& detections, const Pose* previous,
                                   const PoseOptions& options) {
  const Skeleton& skeleton = actor.skeleton;
  std::vector<RestAngle> rest;
  rest.reserve(skeleton.n_dofs());
  for (const Dof& dof : skeleton.dofs) rest.push_back({dof.rest_rad, options.weights.rest * dof.rest_share});
  if (!previous || !(options.hidden_share > 0)) return rest;
  for (const ArmPoints& arm : kArmPoints) {
    const auto hidden = [&](Keypoint k) { return !(detections.keypoints[k].confidence >= options.hidden_confidence); };
    if (!hidden(arm.wrist)) continue;
    const int held = skeleton.bone_index(hidden(arm.elbow) ? arm.shoulder : arm.forearm);
    for (int k = 0; held >= 0 && k < skeleton.n_dofs(); ++k)
      if (hangs_on(skeleton, skeleton.dofs[k].bone, held))
        rest[k] = {previous->angles_rad[k], options.weights.rest * options.hidden_share};
  }
  return rest;
}

double held_energy(const Actor& actor, const Detections& detections, const Pose& previous, const PoseOptions& options,
                   const Pose& pose) {
  return rest_energy(rest_angles(actor, detections, &previous, options), pose) -
         rest_energy(rest_angles(actor, detections, nullptr, options), pose);
}

}  // namespace livecap
