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
constexpr Keypoint kLeftLeg[] = {kLeftKnee, kLeftAnkle, kLeftToe};
constexpr Keypoint kRightLeg[] = {kRightKnee, kRightAnkle, kRightToe};
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
  share("thigh_forward", thigh_forward);
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

  for (const auto& [hip, knee, leg] : {std::tuple{kLeftHip, kLeftKnee, std::span<const Keypoint>(kLeftLeg)},
                                       std::tuple{kRightHip, kRightKnee, std::span<const Keypoint>(kRightLeg)}}) {
    const Eigen::Vector3d thigh = at(knee) - at(hip);
    if (!(thigh.norm() > kShortestMm)) continue;
    const double forward_lean = thigh.z() / thigh.norm() + options.thigh_forward * forward.z();
    move(leg, with_lean(thigh, forward_lean) - thigh, keypoints);
  }
}

}  // namespace livecap::detect
