#include "pose/balance.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

using Positions = std::array<Eigen::Vector3d, kKeypointCount>;

// From one keypoint towards another, and whose mass that is.
struct Segment {
  Keypoint from, to;
  double mass;    // share of the body's
  double centre;  // share of the way
};

constexpr Segment kLimbs[] = {
    {kLeftShoulder, kLeftElbow, 0.028, 0.436}, {kRightShoulder, kRightElbow, 0.028, 0.436},
    {kLeftElbow, kLeftWrist, 0.022, 0.682},    {kRightElbow, kRightWrist, 0.022, 0.682},
    {kLeftHip, kLeftKnee, 0.100, 0.433},       {kRightHip, kRightKnee, 0.100, 0.433},
    {kLeftKnee, kLeftAnkle, 0.061, 0.606},     {kRightKnee, kRightAnkle, 0.061, 0.606},
};
constexpr double kHeadMass = 0.081;
constexpr double kTrunkMass = 0.497;  // its centre is half way from the hips to the shoulders

// From the ankles to the middle of the soles: whoever stands has the weight some 40 mm before the ankles.
constexpr double kBeforeAnkles = 0.5;

struct LegKeypoints {
  Keypoint hip, knee, ankle;
};
constexpr LegKeypoints kLegs[] = {{kLeftHip, kLeftKnee, kLeftAnkle}, {kRightHip, kRightKnee, kRightAnkle}};

bool has(const Actor& actor, std::initializer_list<Keypoint> keypoints) {
  return std::all_of(keypoints.begin(), keypoints.end(), [&](Keypoint k) { return actor.keypoints[k].bone >= 0; });
}

}  // namespace

std::optional<Eigen::Vector3d> centre_of_mass(const Actor& actor, const Positions& positions) {
  if (!has(actor, {kNeck})) return std::nullopt;
  const Eigen::Vector3d hips = (positions[kLeftHip] + positions[kRightHip]) / 2;
  const Eigen::Vector3d shoulders = (positions[kLeftShoulder] + positions[kRightShoulder]) / 2;
  Eigen::Vector3d sum = kHeadMass * positions[kNeck] + kTrunkMass * (hips + shoulders) / 2;
  for (const Segment& limb : kLimbs) {
    if (!has(actor, {limb.from, limb.to})) return std::nullopt;
    sum += limb.mass * ((1 - limb.centre) * positions[limb.from] + limb.centre * positions[limb.to]);
  }
  return sum;  // the masses sum to 1
}

double leg_reach(const Actor& actor, const Positions& positions, const Eigen::Vector3d& up) {
  double reach = 0;
  for (const auto& [hip, knee, ankle] : kLegs) {
    if (!has(actor, {hip, knee, ankle})) continue;
    const double length = (positions[hip] - positions[knee]).norm() + (positions[knee] - positions[ankle]).norm();
    if (length > 0) reach = std::max(reach, up.dot(positions[hip] - positions[ankle]) / length);
  }
  return reach;
}

Eigen::Vector3d away_along_floor(const Eigen::Vector3d& up) {
  return (Eigen::Vector3d::UnitZ() - up * up.z()).normalized();
}

std::optional<double> support_beyond_mass_mm(const Actor& actor, const Positions& positions,
                                             const Eigen::Vector3d& soles_mm, const Eigen::Vector3d& up,
                                             double least_reach) {
  if (leg_reach(actor, positions, up) < least_reach) return std::nullopt;
  const std::optional<Eigen::Vector3d> mass = centre_of_mass(actor, positions);
  if (!mass) return std::nullopt;
  const Eigen::Vector3d ankles = (positions[kLeftAnkle] + positions[kRightAnkle]) / 2;
  const Eigen::Vector3d support = ankles + kBeforeAnkles * (soles_mm - ankles);
  return away_along_floor(up).dot(support - *mass);
}

void BalanceOptions::validate() const {
  if (!(most_mm >= 0) || !std::isfinite(most_mm))
    throw ConfigError(format("balance: most_mm is %g; it must be finite and at least 0", most_mm));
  if (!(frames >= 1) || !std::isfinite(frames))
    throw ConfigError(format("balance: frames is %g; it must be finite and at least 1", frames));
  if (!(sole_frames >= 1) || !std::isfinite(sole_frames))
    throw ConfigError(format("balance: sole_frames is %g; it must be finite and at least 1", sole_frames));
  if (!(least_reach >= 0 && least_reach <= 1))
    throw ConfigError(format("balance: least_reach is %g; it must be in 0..1", least_reach));
  if (!(share >= 0 && share <= 1)) throw ConfigError(format("balance: share is %g; it must be in 0..1", share));
  if (!std::isfinite(middle_mm)) throw ConfigError(format("balance: middle_mm is %g; it must be finite", middle_mm));
}

BalanceOptions no_balance() {
  BalanceOptions options;
  options.most_mm = std::numeric_limits<double>::max();
  options.share = 0;
  return options;
}

Balance::Balance(const BalanceOptions& options) : options_(options) {
  options.validate();
}

bool Balance::learn(const Actor& actor, const Positions& positions, const Eigen::Vector3d& soles_mm,
                    const Eigen::Vector3d& up) {
  const auto farther_mm = support_beyond_mass_mm(actor, positions, soles_mm, up, options_.least_reach);
  if (!farther_mm) return false;
  n_frames_ = std::min(n_frames_ + 1, options_.frames);
  farther_mm_ += (*farther_mm - farther_mm_) / n_frames_;
  return true;
}

void Balance::forget() {
  n_frames_ = 0;
  farther_mm_ = 0;
}

double Balance::excess_mm() const {
  return std::copysign(std::max(0.0, std::abs(farther_mm_) - options_.most_mm), farther_mm_);
}

SoleInBalance::SoleInBalance(const BalanceOptions& options) : options_(options) {
  options.validate();
}

void SoleInBalance::learn(const Actor& actor, const Positions& positions, const Eigen::Vector3d& soles_mm,
                          const Eigen::Vector3d& lowest_mm, const Eigen::Vector3d& up, double weight) {
  const auto farther_mm = support_beyond_mass_mm(actor, positions, soles_mm, up, options_.least_reach);
  if (!farther_mm || !(weight > 0)) return;
  const double move = (*farther_mm - options_.middle_mm) / away_along_floor(up).dot(lowest_mm);
  n_frames_ = std::min(n_frames_ + weight, options_.sole_frames);
  place_mm_ += weight * ((1 - move) * lowest_mm - place_mm_) / n_frames_;
}

void SoleInBalance::forget() {
  n_frames_ = 0;
  place_mm_.setZero();
}

std::optional<Eigen::Vector3d> SoleInBalance::place_mm() const {
  if (n_frames_ == 0) return std::nullopt;
  return place_mm_;
}

}  // namespace livecap
