// Arms as the picture cannot have them apart: an upper arm or a forearm that points as far from the camera as another
// one points towards it has the same outline. Where such an arm is the likelier one, stage I is solved from there as
// well.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "actor/actor.h"
#include "livecap/detections.h"
#include "pose/pose_options.h"

namespace livecap {

struct MirroredForearm {
  Keypoint elbow = kLeftElbow;  // or kRightElbow
  int bone = 0;                 // the forearm's
  Eigen::Matrix3d turn;         // of the forearm, camera frame
  Eigen::Vector3d wrist_mm;     // camera frame: the other place on its ray that is as far from the elbow
};

// nullopt when the forearm would turn by less than least_turn_rad, or the actor has no such arm.
std::optional<MirroredForearm> mirrored_forearm(const Actor& actor, const Pose& pose, Keypoint elbow,
                                                double least_turn_rad);

// `pose` with the arm's joints as they must be (searched for: some hundred poses).
Pose with_mirrored_forearm(const Actor& actor, const Pose& pose, const MirroredForearm& mirrored);

struct MirroredArmOptions {
  // Of the two bones' unit vectors along the ray to the elbow, the pose's against the 3D detections': the sum of
  // squared differences from which an arm is mirrored, and the share of it that a mirrored one may have. The network is
  // off by 0.2 to 0.4 (rms) itself.
  double least_difference = 0.7;
  double largest_share = 0.7;
};

// `pose` with the upper arm, the forearm or both mirrored in depth where the 3D detections have the arm rather so. A
// forearm below a mirrored upper arm ends on the wrist's ray as it did. Empty when the detections agree with the pose
// or are not sure, or the actor has no such arm.
std::vector<Pose> mirrored_arms(const Actor& actor, const Pose& pose, Keypoint elbow, const Detections& detections,
                                const PoseOptions& options, const MirroredArmOptions& mirrored);

}  // namespace livecap
