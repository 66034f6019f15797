#include "detect/posture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <span>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap::detect {
namespace {

using Keypoints = std::array<KeypointDetection, kKeypointCount>;

constexpr Keypoint kTrunk[] = {kNeck,       kHeadTop,   kLeftShoulder, kRightShoulder, kLeftElbow,
                               kRightElbow, kLeftWrist, kRightWrist,   kLeftHand,      kRightHand,
                               kLeftEye,    kRightEye,  kNose,         kChin};
constexpr Keypoint kLeftLeg[] = {kLeftHip, kLeftKnee, kLeftAnkle, kLeftToe};
constexpr Keypoint kRightLeg[] = {kRightHip, kRightKnee, kRightAnkle, kRightToe};
constexpr Keypoint kLeftArm[] = {kLeftShoulder, kLeftElbow, kLeftWrist, kLeftHand};
constexpr Keypoint kRightArm[] = {kRightShoulder, kRightElbow, kRightWrist, kRightHand};
constexpr double kSteepest = 0.99;
constexpr double kShortestMm = 1;

Eigen::Vector3d position_mm(const KeypointDetection& k) {
  return {k.x_mm, k.y_mm, k.z_mm};
}

void move(std::span<const Keypoint> which, const Eigen::Vector3d& by_mm, Keypoints& keypoints) {
  for (Keypoint k : which) {
    keypoints[k].x_mm += static_cast<float>(by_mm.x());
    keypoints[k].y_mm += static_cast<float>(by_mm.y());
    keypoints[k].z_mm += static_cast<float>(by_mm.z());
  }
}

// The vector of the same length and direction in the picture whose unit vector has this z, but no steeper than
// kSteepest unless v is. One that points at the camera has no direction in the picture and stays.
Eigen::Vector3d with_lean(const Eigen::Vector3d& v, double lean) {
  const double across = v.head<2>().norm();
  if (!(across > 0)) return v;
  const double steepest = std::max(kSteepest, std::abs(v.z()) / v.norm());
  const double z = std::clamp(lean, -steepest, steepest);
  const double scale = std::sqrt(1 - z * z) * v.norm() / across;
  return {v.x() * scale, v.y() * scale, z * v.norm()};
}

}  // namespace

void PostureOptions::validate() const {
  const auto share = [](const char* field, double value) {
    if (!(value >= 0 && value <= 1)) throw ConfigError(format("posture: %s is %g; it must be in 0..1", field, value));
  };
  const auto positive = [](const char* field, double value) {
    if (!(value > 0) || !std::isfinite(value))
      throw ConfigError(format("posture: %s is %g; it must be positive and finite", field, value));
  };
  share("lean_dead_zone", lean_dead_zone);
  share("seen_forward_lean", seen_forward_lean);
  share("usual_forward_lean", usual_forward_lean);
  positive("camera_memory_s", camera_memory_s);
  positive("camera_level_s", camera_level_s);
  const auto bias = [](const char* field, const LimbBias& value) {
    for (double part : {value.outward, value.upward, value.forward}) {
      if (!(std::abs(part) <= 1))
        throw ConfigError(format("posture: a part of %s is %g; it must be in -1..1", field, part));
    }
  };
  bias("thigh", thigh);
  bias("upper_arm", upper_arm);
  bias("forearm", forearm);
}

void Posture::update(const PostureOptions& options, double dt_s, Keypoints& keypoints) {
  const auto at = [&](Keypoint k) { return position_mm(keypoints[k]); };
  const Eigen::Vector3d trunk = at(kNeck) - at(kPelvis);
  const Eigen::Vector3d across = at(kLeftHip) - at(kRightHip) + at(kLeftShoulder) - at(kRightShoulder);
  const Eigen::Vector3d front = across.cross(trunk);
  if (!(trunk.norm() > kShortestMm) || !(front.norm() > kShortestMm)) return;
  const Eigen::Vector3d forward = front.normalized();

  const double lean = trunk.z() / trunk.norm();
  if (seen_s_ == 0) {
    seen_s_ = options.camera_level_s;
    tilt_ = 0;
  }
  seen_s_ = std::min(seen_s_ + dt_s, options.camera_memory_s);
  tilt_ += std::min(1.0, dt_s / seen_s_) * (lean - options.seen_forward_lean * forward.z() - tilt_);
  const double usual = tilt_ + options.usual_forward_lean * forward.z();
  const double beyond = std::max(0.0, std::abs(lean - usual) - options.lean_dead_zone);
  move(kTrunk, with_lean(trunk, usual + std::copysign(beyond, lean - usual)) - trunk, keypoints);

  // The trunk's axes as the network sees them, for what the network sees in relation to them.
  const Eigen::Vector3d up = trunk.normalized();
  const Eigen::Vector3d left = up.cross(forward);
  // chain: from, to, and what hangs on `to`.
  const auto correct = [&](std::span<const Keypoint> chain, const Eigen::Vector3d& outward, const LimbBias& bias) {
    const Eigen::Vector3d limb = at(chain[1]) - at(chain[0]);
    const double length_mm = limb.norm();
    if (!(length_mm > kShortestMm)) return;
    const Eigen::Vector3d wanted =
        limb / length_mm + bias.outward * outward + bias.upward * up + bias.forward * forward;
    if (wanted.norm() > 0) move(chain.subspan(1), wanted.normalized() * length_mm - limb, keypoints);
  };
  for (const auto& [outward, leg, arm] :
       {std::tuple{left, std::span(kLeftLeg), std::span(kLeftArm)},
        std::tuple{Eigen::Vector3d(-left), std::span(kRightLeg), std::span(kRightArm)}}) {
    correct(leg, outward, options.thigh);
    correct(arm, outward, options.upper_arm);
    correct(arm.subspan(1), outward, options.forearm);
  }
}

}  // namespace livecap::detect
