#include "capture/expected_detections.h"

#include "pose/targets.h"

namespace livecap {

Detections expected_detections(const Actor& actor, const Camera& camera, const Pose& pose, float confidence) {
  Detections detections;
  detections.person = true;
  detections.score = 1;
  const auto positions = keypoint_positions(actor, forward_kinematics(actor.skeleton, pose));
  for (int k = 0; k < kKeypointCount; ++k) {
    if (actor.keypoints[k].bone < 0) continue;
    const Eigen::Vector2d px = project_px(camera, positions[k]);
    const Eigen::Vector3d relative = positions[k] - positions[kPelvis];
    detections.keypoints[k] = {static_cast<float>(px.x()),       static_cast<float>(px.y()),
                               static_cast<float>(relative.x()), static_cast<float>(relative.y()),
                               static_cast<float>(relative.z()), confidence};
  }
  return detections;
}

}  // namespace livecap
