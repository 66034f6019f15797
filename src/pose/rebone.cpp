#include "pose/rebone.h"

#include <algorithm>
#include <cmath>

namespace livecap {
namespace {

// Parents come first when keypoints are visited in this order.
constexpr std::array<int, kKeypointCount> kOutward = {
    kPelvis,     kLeftHip,  kRightHip,  kLeftKnee,     kRightKnee,     kLeftAnkle, kRightAnkle, kLeftToe,
    kRightToe,   kNeck,     kHeadTop,   kLeftShoulder, kRightShoulder, kLeftElbow, kRightElbow, kLeftWrist,
    kRightWrist, kLeftHand, kRightHand, kLeftEye,      kRightEye,      kNose,      kChin};

// Directions between points nearer than this mean nothing.
constexpr double kShortestBoneMm = 1.0;

Eigen::Vector3d detected_mm(const KeypointDetection& detection) {
  return {detection.x_mm, detection.y_mm, detection.z_mm};
}

double usable_confidence(const KeypointDetection& detection) {
  if (!std::isfinite(detection.confidence) || !detected_mm(detection).allFinite()) return 0;
  return std::clamp<double>(detection.confidence, 0, 1);
}

}  // namespace

int keypoint_parent(int keypoint) {
  switch (keypoint) {
    case kPelvis:
      return -1;
    case kNeck:
    case kLeftHip:
    case kRightHip:
      return kPelvis;
    case kLeftElbow:
      return kLeftShoulder;
    case kRightElbow:
      return kRightShoulder;
    case kLeftWrist:
      return kLeftElbow;
    case kRightWrist:
      return kRightElbow;
    case kLeftHand:
      return kLeftWrist;
    case kRightHand:
      return kRightWrist;
    case kLeftKnee:
      return kLeftHip;
    case kRightKnee:
      return kRightHip;
    case kLeftAnkle:
      return kLeftKnee;
    case kRightAnkle:
      return kRightKnee;
    case kLeftToe:
      return kLeftAnkle;
    case kRightToe:
      return kRightAnkle;
    default:  // head top, shoulders, face
      return kNeck;
  }
}

Keypoints3d rebone(const Actor& actor, const Detections& detections) {
  Keypoints3d result;
  const KeypointAnchor& pelvis = actor.keypoints[kPelvis];
  if (!detections.person || pelvis.bone < 0) return result;
  const double pelvis_confidence = usable_confidence(detections.keypoints[kPelvis]);
  result[kPelvis].confidence = pelvis_confidence > 0 ? pelvis_confidence : 1;
  const Eigen::Vector3d origin_mm =
      pelvis_confidence > 0 ? detected_mm(detections.keypoints[kPelvis]) : Eigen::Vector3d::Zero();
  for (int k : kOutward) {
    if (k == kPelvis || actor.keypoints[k].bone < 0) continue;
    int parent = keypoint_parent(k);
    while (actor.keypoints[parent].bone < 0) parent = keypoint_parent(parent);
    const Eigen::Vector3d parent_mm = parent == kPelvis ? origin_mm : detected_mm(detections.keypoints[parent]);
    const double confidence = std::min(usable_confidence(detections.keypoints[k]), result[parent].confidence);
    if (!(confidence > 0)) continue;
    const Eigen::Vector3d bone_mm = detected_mm(detections.keypoints[k]) - parent_mm;
    const double detected_length_mm = bone_mm.norm();
    if (detected_length_mm < kShortestBoneMm) continue;
    const double length_mm = (actor.keypoints[k].rest_position_mm - actor.keypoints[parent].rest_position_mm).norm();
    result[k].position_mm = result[parent].position_mm + bone_mm * (length_mm / detected_length_mm);
    result[k].confidence = confidence;
  }
  if (!(pelvis_confidence > 0)) result[kPelvis].confidence = 0;
  return result;
}

Keypoints3d keypoints_3d(const Actor& actor, const Detections& detections) {
  Keypoints3d result;
  if (!detections.person) return result;
  for (int k = 0; k < kKeypointCount; ++k) {
    if (actor.keypoints[k].bone < 0) continue;
    result[k].confidence = usable_confidence(detections.keypoints[k]);
    if (result[k].confidence > 0) result[k].position_mm = detected_mm(detections.keypoints[k]);
  }
  return result;
}

}  // namespace livecap
