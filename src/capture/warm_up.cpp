#include "capture/warm_up.h"

#include <cmath>

namespace livecap {

void warm_up_detector(detect::PoseDetector& detector, const Camera& camera) {
  ImageRgb picture{camera.width, camera.height, std::vector<uint8_t>(size_t(3) * camera.width * camera.height, 128)};
  detector.detect(picture, camera, 0);
  detector.reset();
}

void warm_up_tracker(Tracker& tracker, const Actor& actor, const Camera& camera) {
  Pose pose = rest_pose(actor.skeleton);
  pose.root_rotation = Eigen::Vector3d(1, -1, -1).asDiagonal();  // upright, facing the camera
  pose.root_translation_mm = {0, 0, 4000};
  const PosedSkeleton posed = forward_kinematics(actor.skeleton, pose);

  Detections detections;
  detections.person = true;
  detections.score = 1;
  for (int k = 0; k < kKeypointCount; ++k) {
    const KeypointAnchor& anchor = actor.keypoints[k];
    if (anchor.bone < 0) continue;
    const Eigen::Vector3d p = posed.camera_from_rest[anchor.bone] * anchor.rest_position_mm;
    const Eigen::Vector3d relative = p - pose.root_translation_mm;
    detections.keypoints[k] = {static_cast<float>(camera.fx * p.x() / p.z() + camera.cx),
                               static_cast<float>(camera.fy * p.y() / p.z() + camera.cy),
                               static_cast<float>(relative.x()),
                               static_cast<float>(relative.y()),
                               static_cast<float>(relative.z()),
                               1.0f};
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
