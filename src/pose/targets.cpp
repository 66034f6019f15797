#include "pose/targets.h"

#include <algorithm>
#include <cmath>

#include "geometry/reference.h"
#include "pose/round_weights.h"

namespace livecap {

std::array<Eigen::Vector3d, kKeypointCount> keypoint_positions(const Actor& actor, const PosedSkeleton& posed) {
  std::array<Eigen::Vector3d, kKeypointCount> positions;
  for (int k = 0; k < kKeypointCount; ++k) {
    const KeypointAnchor& anchor = actor.keypoints[k];
    positions[k] = Eigen::Vector3d::Zero();
    if (anchor.bone >= 0) positions[k] = posed.camera_from_rest[anchor.bone] * anchor.rest_position_mm;
  }
  return positions;
}

Eigen::Vector2d project_px(const Camera& camera, const Eigen::Vector3d& point_mm) {
  const reference::Pinhole pinhole{camera.fx, camera.fy, camera.cx, camera.cy};
  const reference::Vec2 px =
      reference::project_point(reference::vec3(point_mm.x(), point_mm.y(), point_mm.z()), pinhole).uv;
  return {px.x, px.y};
}

Keypoints3d detected_points(const Actor& actor, const Detections& detections, const PoseOptions& options) {
  return options.rebone ? rebone(actor, detections) : keypoints_3d(actor, detections);
}

KeypointTargets make_targets(const Actor& actor, const Detections& detections, const Pose* previous,
                             const PoseOptions& options) {
  KeypointTargets targets;
  const Keypoints3d points = detected_points(actor, detections, options);
  std::array<Eigen::Vector3d, kKeypointCount> previous_positions;
  if (previous) previous_positions = keypoint_positions(actor, forward_kinematics(actor.skeleton, *previous));
  for (int k = 0; k < kKeypointCount; ++k) {
    if (actor.keypoints[k].bone < 0) continue;
    KeypointTarget& target = targets[k];
    const KeypointDetection& detection = detections.keypoints[k];
    if (detections.person && std::isfinite(detection.x_px) && std::isfinite(detection.y_px) &&
        std::isfinite(detection.confidence)) {
      target.position_px = {detection.x_px, detection.y_px};
      target.weight_2d =
          options.weights.keypoint_2d * options.keypoint_2d_weights[k] * std::clamp<double>(detection.confidence, 0, 1);
    }
    target.detection_mm = points[k].position_mm;
    target.weight_3d = options.weights.keypoint_3d * options.keypoint_3d_weights[k] * points[k].confidence;
    if (previous) {
      target.previous_position_mm = previous_positions[k];
      target.weight_temporal = options.weights.temporal * options.temporal_weights[k];
    }
  }
  return targets;
}

Eigen::Vector3d best_t_prime(const KeypointTargets& targets,
                             const std::array<Eigen::Vector3d, kKeypointCount>& positions) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double total = 0;
  for (int k = 0; k < kKeypointCount; ++k) {
    sum += targets[k].weight_3d * (positions[k] - targets[k].detection_mm);
    total += targets[k].weight_3d;
  }
  return total > 0 ? Eigen::Vector3d(sum / total) : Eigen::Vector3d::Zero();
}

void doubt_far_detections(KeypointTargets& targets, const std::array<Eigen::Vector3d, kKeypointCount>& positions,
                          double scale_mm) {
  const Eigen::Vector3d t_prime = best_t_prime(targets, positions);
  for (int k = 0; k < kKeypointCount; ++k) {
    const Eigen::Vector3d r_mm = positions[k] - targets[k].detection_mm - t_prime;
    targets[k].weight_3d /= cauchy_doubt(r_mm.squaredNorm(), scale_mm);
  }
}

double doubted_cost(double r_squared, double scale) {
  return scale > 0 ? r_squared / cauchy_doubt(r_squared, scale) : r_squared;
}

}  // namespace livecap
