// Who stands has the feet below the centre of mass: not in every frame, but over a while. It tells the depth of legs
// where the picture does not: under a long skirt a thigh swings forward and a shin back, while knee and foot stay where
// they are seen.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "actor/actor.h"
#include "base/detections.h"

namespace livecap {

// Of the body, mm, camera frame, with its keypoints at `positions`; the head where the neck is. Shares of the parts and
// where their own centres lie: Winter, Biomechanics and Motor Control of Human Movement, table "anthropometric data".
// nullopt when the actor lacks one of the keypoints.
std::optional<Eigen::Vector3d> centre_of_mass(const Actor& actor,
                                              const std::array<Eigen::Vector3d, kKeypointCount>& positions);

// How far the straighter leg reaches down along `up` (unit) from the hip to the ankle, as a share of its length; 0 when
// the actor lacks one of the keypoints.
double leg_reach(const Actor& actor, const std::array<Eigen::Vector3d, kKeypointCount>& positions,
                 const Eigen::Vector3d& up);

// How much farther from the camera, along the floor, what bears the weight is than the centre of mass, mm: half way
// from the ankles to the middle between both soles. nullopt for who does not stand (least_reach), or cannot be weighed.
std::optional<double> support_beyond_mass_mm(const Actor& actor,
                                             const std::array<Eigen::Vector3d, kKeypointCount>& positions,
                                             const Eigen::Vector3d& soles_mm, const Eigen::Vector3d& up,
                                             double least_reach);

struct BalanceOptions {
  // How far, on average, what bears the weight may lie nearer or farther than the centre of mass, along the floor, mm.
  double most_mm = 60;
  double frames = 60;  // after so many a frame's say has fallen to 1/e; those before that count alike
  // Only of frames in which a leg reaches down by so much of its length: who sits or kneels has the feet elsewhere.
  double least_reach = 0.75;
  // So much of a floor's height is told by balance: by where the captured feet would have to be, the more where the
  // picture tells little of them (HiddenKneesOptions); the rest by feet at rest, which anchor it, since it holds the
  // captured feet itself. 0: the limit above alone.
  double share = 0.4;
  double middle_mm = -10;    // farther than the centre of mass is what bears the weight then, on average
  double sole_frames = 120;  // as `frames`, in which it rests

  void validate() const;  // throws ConfigError
};

// That limits nothing and tells nothing of a floor.
BalanceOptions no_balance();

class Balance {
 public:
  // Throws ConfigError.
  explicit Balance(const BalanceOptions& options);

  // A frame's keypoints, and the middle between both soles. False: it tells nothing.
  bool learn(const Actor& actor, const std::array<Eigen::Vector3d, kKeypointCount>& positions,
             const Eigen::Vector3d& soles_mm, const Eigen::Vector3d& up);
  void forget();

  // By how much the feet of the frames so far were farther than they may be, mm, along the floor away from the camera;
  // negative: nearer.
  double excess_mm() const;

 private:
  BalanceOptions options_;
  double n_frames_ = 0;
  double farther_mm_ = 0;  // what bears the weight than the centre of mass, mean
};

// Where the lower sole would rest on average if who stands on it was in balance: moved along its line of sight, which
// the picture tells.
class SoleInBalance {
 public:
  // Throws ConfigError.
  explicit SoleInBalance(const BalanceOptions& options);

  // A frame's keypoints, the middle between both soles and the lowest point of them, and how sure that is to rest,
  // 0..1.
  void learn(const Actor& actor, const std::array<Eigen::Vector3d, kKeypointCount>& positions,
             const Eigen::Vector3d& soles_mm, const Eigen::Vector3d& lowest_mm, const Eigen::Vector3d& up,
             double weight);
  void forget();

  // mm, camera frame; nullopt while nobody has stood.
  std::optional<Eigen::Vector3d> place_mm() const;

 private:
  BalanceOptions options_;
  double n_frames_ = 0;  // by weight
  Eigen::Vector3d place_mm_ = Eigen::Vector3d::Zero();
};

// Of the floor, away from the camera; unit.
Eigen::Vector3d away_along_floor(const Eigen::Vector3d& up);

}  // namespace livecap
