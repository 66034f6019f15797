#include "capture/warm_up.h"

#include <cmath>

namespace livecap {

void warm_up_detector(detect::PoseDetector& detector, const Camera& camera) {
  ImageRgb picture{camera.width, camera.height, std::vector<uint8_t>(size_t(3) * camera.width * camera.height, 128)};
  detector.detect(picture, camera, 0, 0);
  detector.reset();
}

void warm_up_tracker(Tracker& tracker, const Actor& actor, const Camera& camera) {
  Pose pose = rest_pose(actor.skeleton);
  pose.root_rotation = Eigen::Vector3d(1, -1, -1).asDiagonal();  // upright, facing the camera
  pose.root_translation_mm = {0, 0, 4000};

  Detections detections;
  detections.person = true;
  detections.score = 1;
  const auto positions = keypoint_positions(actor, forward_kinematics(actor.skeleton, pose));
  for (int k = 0; k < kKeypointCount; ++k) {
    if (actor.keypoints[k].bone < 0) continue;
    const Eigen::Vector2d px = project_px(camera, positions[k]);
    const Eigen::Vector3d relative = positions[k] - pose.root_translation_mm;
    detections.keypoints[k] = {static_cast<float>(px.x()),       static_cast<float>(px.y()),
                               static_cast<float>(relative.x()), static_cast<float>(relative.y()),
                               static_cast<float>(relative.z()), 1.0f};
  }
  // A box for a silhouette is enough: what comes out is thrown away.
  ImageGray mask{camera.width, camera.height, std::vector<uint8_t>(size_t(camera.width) * camera.height, 0)};
  for (int y = camera.height / 4; y < camera.height * 3 / 4; ++y) {
    for (int x = camera.width / 3; x < camera.width * 2 / 3; ++x) mask.pixels[size_t(y) * camera.width + x] = 255;
  }
  const ImageRgb picture{camera.width, camera.height,
                         std::vector<uint8_t>(size_t(3) * camera.width * camera.height, 128)};
  const Silhouette silhouette = make_silhouette(mask);
  for (int frame = 0; frame < 3; ++frame) tracker.track({picture, detections, silhouette, mask});
  tracker.reset();
}

}  // namespace livecap
