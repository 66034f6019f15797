#include "capture/warm_up.h"

#include "capture/expected_detections.h"

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

  const Detections detections = expected_detections(actor, camera, pose, 1);
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
