// An arm as a chain of joint angles, and how it reaches a place: for starts of stage I (mirrored_arms.h,
// other_starts.h), not for solving.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "actor/actor.h"
#include "livecap/detections.h"

namespace livecap {

struct ArmChain {
  Keypoint shoulder, elbow, wrist;
  int upper, lower;       // bones
  std::vector<int> aims;  // angles of the upper arm but its twist
  int twist, bend;        // angles
};

// elbow: kLeftElbow or kRightElbow. nullopt when the actor has no such arm.
std::optional<ArmChain> arm_chain(const Actor& actor, Keypoint elbow);

// `pose` with the elbow as near to `target` (camera frame, mm) as the upper arm's aims bring it, from where they are.
Pose with_elbow_at(const Actor& actor, const ArmChain& arm, Pose pose, const Eigen::Vector3d& target);

// `pose` with the wrist as near to `target` as the upper arm's twist and the elbow's bend bring it; the twist is
// searched for and stays off its limits.
Pose with_wrist_at(const Actor& actor, const ArmChain& arm, const Pose& pose, const Eigen::Vector3d& target);

}  // namespace livecap
