#include "pose/leg_bias.h"

#include <cmath>
#include <span>
#include <utility>

#include "base/text.h"
#include "livecap/error.h"
#include "pose/targets.h"

namespace livecap {
namespace {

constexpr Keypoint kLegChains[2][4] = {{kLeftHip, kLeftKnee, kLeftAnkle, kLeftToe},
                                       {kRightHip, kRightKnee, kRightAnkle, kRightToe}};
constexpr double kShortestMm = 1;

Eigen::Vector3d limb_mm(const KeypointDetections& k, int from, int to) {
  return {double(k[to].x_mm) - k[from].x_mm, double(k[to].y_mm) - k[from].y_mm, double(k[to].z_mm) - k[from].z_mm};
}

// z of where the pelvis faces: -1 towards the camera.
double facing(const Pose& pose) {
  return pose.root_rotation(2, 2);
}

// What hangs on the end of chain's first limb moves along.
void lean(std::span<const Keypoint> chain, double by, KeypointDetections& k) {
  const Eigen::Vector3d limb = limb_mm(k, chain[0], chain[1]);
  const double length_mm = limb.norm();
  if (!(length_mm > kShortestMm)) return;
  const Eigen::Vector3d wanted = (limb / length_mm + by * Eigen::Vector3d::UnitZ()).normalized() * length_mm;
  const Eigen::Vector3f move_mm = (wanted - limb).cast<float>();
  for (Keypoint moved : chain.subspan(1)) {
    k[moved].x_mm += move_mm.x();
    k[moved].y_mm += move_mm.y();
    k[moved].z_mm += move_mm.z();
  }
}

}  // namespace

void LegBiasOptions::validate() const {
  for (const auto& [field, value] : {std::pair{"memory", memory}, std::pair{"prior", prior}})
    if (!(value > 0) || !std::isfinite(value))
      throw ConfigError(format("leg bias: %s is %g; it must be finite and above 0", field, value));
}

LegBias::LegBias(const LegBiasOptions& options) : options_(options) {
  options.validate();
}

void LegBias::learn(const Actor& actor, const KeypointDetections& detected, const Pose& pose) {
  const auto solved = keypoint_positions(actor, forward_kinematics(actor.skeleton, pose));
  for (const auto& leg : kLegChains) {
    add(actor, detected, pose, solved, leg[0], leg[1], thigh_);
    add(actor, detected, pose, solved, leg[1], leg[2], shin_);
  }
}

void LegBias::add(const Actor& actor, const KeypointDetections& detected, const Pose& pose,
                  const std::array<Eigen::Vector3d, kKeypointCount>& solved, int from, int to, Mean& mean) const {
  if (actor.keypoints[from].bone < 0 || actor.keypoints[to].bone < 0) return;
  if (!(detected[from].confidence >= kTrustedDetection) || !(detected[to].confidence >= kTrustedDetection)) return;
  const Eigen::Vector3d seen = limb_mm(detected, from, to), own = solved[to] - solved[from];
  if (!(seen.norm() > kShortestMm) || !(own.norm() > kShortestMm)) return;
  const double missing = own.z() / own.norm() - seen.z() / seen.norm();
  const double weight = facing(pose) * facing(pose) / std::size(kLegChains), fade = std::exp(-weight / options_.memory);
  mean.sum = fade * mean.sum + facing(pose) * missing / std::size(kLegChains);
  mean.weight = fade * mean.weight + weight;
}

KeypointDetections LegBias::corrected(const KeypointDetections& detected, const Pose& pose) const {
  KeypointDetections result = detected;
  for (const auto& leg : kLegChains) {
    lean(leg, facing(pose) * bias(thigh_), result);
    lean(std::span(leg).subspan(1), facing(pose) * bias(shin_), result);
  }
  return result;
}

}  // namespace livecap
