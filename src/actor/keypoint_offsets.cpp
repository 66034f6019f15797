#include "actor/keypoint_offsets.h"

#include <algorithm>

namespace livecap {
namespace {

constexpr double kTableHeightMm = 1700;

double height_mm(const Actor& actor) {
  float low = 0, high = 0;
  for (size_t i = 1; i < actor.mesh.positions.size(); i += 3) {
    low = i == 1 ? actor.mesh.positions[i] : std::min(low, actor.mesh.positions[i]);
    high = i == 1 ? actor.mesh.positions[i] : std::max(high, actor.mesh.positions[i]);
  }
  return high - low;
}

}  // namespace

void use_mediapipe_anchors(Actor& actor) {
  auto& anchors = actor.keypoints;
  const double scale = height_mm(actor) / kTableHeightMm;
  auto known = [&](int k) { return anchors[k].bone >= 0; };
  auto move = [&](int k, double x, double y, double z) {
    if (known(k)) anchors[k].rest_position_mm += scale * Eigen::Vector3d(x, y, z);
  };
  auto between = [&](int a, int b, double share) {
    return Eigen::Vector3d((1 - share) * anchors[a].rest_position_mm + share * anchors[b].rest_position_mm);
  };

  // The shoulder landmark lies on the acromion, above the joint, and does not turn with the arm.
  for (int k : {kLeftShoulder, kRightShoulder}) {
    if (!known(k)) continue;
    anchors[k].bone = std::max(0, actor.skeleton.bones[anchors[k].bone].parent);
    move(k, 0, 20, 0);
  }
  // The adapter's neck is the midpoint of the shoulders, its pelvis that of the hips: of the trunk, not of neck or
  // legs.
  if (known(kLeftShoulder) && known(kRightShoulder)) {
    const int neck = anchors[kNeck].bone;
    const int chest = neck > 0 ? actor.skeleton.bones[neck].parent : 0;
    anchors[kNeck] = {chest, between(kLeftShoulder, kRightShoulder, 0.5)};
  }
  if (known(kLeftHip) && known(kRightHip)) anchors[kPelvis] = {0, between(kLeftHip, kRightHip, 0.5)};
  // The adapter's hand is the mean of wrist and finger landmarks, halfway to the knuckles.
  for (const auto& [hand, wrist] : {std::pair{kLeftHand, kLeftWrist}, std::pair{kRightHand, kRightWrist}}) {
    if (known(hand) && known(wrist)) anchors[hand].rest_position_mm = between(wrist, hand, 0.6);
  }
  // Bony points instead of joint centres: the outside of the elbow, the far end of the wrist, the front of the ankle.
  for (int k : {kLeftElbow, kRightElbow}) move(k, 0, 0, 12);
  move(kLeftWrist, 15, 0, 0);
  move(kRightWrist, -15, 0, 0);
  for (int k : {kLeftAnkle, kRightAnkle}) move(k, 0, 8, 22);
  // Tip of the foot instead of the joint of the toes.
  for (int k : {kLeftToe, kRightToe}) move(k, 0, -15, 40);
  // The mouth stands for the chin.
  if (known(kChin) && known(kNose)) anchors[kChin].rest_position_mm = between(kChin, kNose, 0.5);
}

}  // namespace livecap
