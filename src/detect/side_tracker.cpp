#include "detect/side_tracker.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap::detect {
namespace {

using Keypoints = std::array<KeypointDetection, kKeypointCount>;
constexpr double kClearTwist = 0.5;  // cosine; hips and shoulders within 60 degrees or beyond 120

using Pair = std::pair<Keypoint, Keypoint>;

constexpr Pair kArms[] = {
    {kLeftShoulder, kRightShoulder}, {kLeftElbow, kRightElbow}, {kLeftWrist, kRightWrist}, {kLeftHand, kRightHand}};
constexpr Pair kLegs[] = {
    {kLeftHip, kRightHip}, {kLeftKnee, kRightKnee}, {kLeftAnkle, kRightAnkle}, {kLeftToe, kRightToe}};
// Too near each other to tell the sides apart, but named together with the arms.
constexpr Pair kEyes = {kLeftEye, kRightEye};
// Without a side; their depth goes with that of the arms.
constexpr Keypoint kMiddle[] = {kHeadTop, kNeck, kNose, kChin};

double distance(const KeypointDetection& a, const KeypointDetection& b, double mm_per_px) {
  return std::hypot(a.x_mm - b.x_mm, a.y_mm - b.y_mm, a.z_mm - b.z_mm) +
         mm_per_px * std::hypot(a.x_px - b.x_px, a.y_px - b.y_px);
}

// Cosine of the angle between the lines through the shoulders and through the hips; negative = they face opposite ways.
double twist_cosine(const Keypoints& k) {
  const auto across = [&](Keypoint left, Keypoint right) {
    return std::array<double, 3>{k[left].x_mm - k[right].x_mm, k[left].y_mm - k[right].y_mm,
                                 k[left].z_mm - k[right].z_mm};
  };
  const auto a = across(kLeftShoulder, kRightShoulder), b = across(kLeftHip, kRightHip);
  const double lengths = std::hypot(a[0], a[1], a[2]) * std::hypot(b[0], b[1], b[2]);
  return lengths > 0 ? (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) / lengths : 0;
}

}  // namespace

void SideTrackerOptions::validate() const {
  if (!(memory_s > 0) || !(change_s > 0) || !std::isfinite(memory_s) || !std::isfinite(change_s))
    throw ConfigError(format("side tracker: memory %g s and change %g s must be positive", memory_s, change_s));
}

bool SideTracker::update(const SideTrackerOptions& options, double dt_s, double mm_per_px, Keypoints& keypoints) {
  changed_sides_ = false;
  if (!started_) {
    started_ = true;
    agreement_s_[0] = agreement_s_[1] = 0;
    last_ = keypoints;
    for (int k = 0; k < kKeypointCount; ++k) agreed_z_mm_[k] = keypoints[k].z_mm;
    return false;
  }
  const double twist = twist_cosine(keypoints);  // as the network has it
  bool any = false;
  for (int group = 0; group < 2; ++group) {
    const std::span<const Pair> pairs = group == 0 ? std::span<const Pair>(kArms) : std::span<const Pair>(kLegs);
    double as_named = 0, exchanged = 0;
    for (const auto& [left, right] : pairs) {
      as_named +=
          distance(keypoints[left], last_[left], mm_per_px) + distance(keypoints[right], last_[right], mm_per_px);
      exchanged +=
          distance(keypoints[left], last_[right], mm_per_px) + distance(keypoints[right], last_[left], mm_per_px);
    }
    bool exchange = exchanged < as_named;
    if (group == 1 && std::abs(twist) > kClearTwist) exchange = any != (twist < 0);
    double& agreement_s = agreement_s_[group];
    agreement_s = std::min(agreement_s + (exchange ? -dt_s : dt_s), options.memory_s);
    if (agreement_s < -options.change_s) {
      exchange = !exchange;
      agreement_s = options.change_s;
      changed_sides_ = true;
    }
    any = any || exchange;
    const auto settle_depth = [&](Keypoint k) {
      if (exchange)
        keypoints[k].z_mm = agreed_z_mm_[k];
      else
        agreed_z_mm_[k] = keypoints[k].z_mm;
    };
    const auto settle = [&](const Pair& pair) {
      if (exchange) std::swap(keypoints[pair.first], keypoints[pair.second]);
      settle_depth(pair.first);
      settle_depth(pair.second);
    };
    for (const Pair& pair : pairs) settle(pair);
    if (group == 0) {
      settle(kEyes);
      for (Keypoint k : kMiddle) settle_depth(k);
    }
  }
  last_ = keypoints;
  return any;
}

}  // namespace livecap::detect
