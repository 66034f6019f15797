// The floor, and the soles that rest on it. A foot on a known floor is at a known depth, where the picture alone tells
// a foot's depth several times less well than its place. Where the floor is, is given, or learned from where feet were
// found to rest, and where balance has them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "actor/actor.h"
#include "base/detections.h"
#include "geometry/skeleton.h"
#include "image/upright_edges.h"
#include "livecap/camera.h"
#include "pose/balance.h"

namespace livecap {

// y in the camera frame of what is upright: above that nobody stands before a level camera.
inline constexpr double kUprightY = -0.5;

struct Floor {
  Eigen::Vector3d up = -Eigen::Vector3d::UnitY();  // unit, camera frame
  double offset_mm = 0;
  double height_mm(const Eigen::Vector3d& point_mm) const { return up.dot(point_mm) + offset_mm; }
};

// nullopt when the camera's floor was not measured.
std::optional<Floor> measured_floor(const Camera& camera);
FloorPlane plane_of(const Floor& floor);

struct SolePoint {
  int bone = 0;
  Eigen::Vector3d rest_mm = Eigen::Vector3d::Zero();  // in the template's rest frame
};

// Six spread over each sole, at the height of its lowest vertex in the rest pose, left foot first; none of a foot that
// the skeleton does not have.
std::vector<SolePoint> sole_points(const Actor& actor);

// How far a point (camera frame, mm) went across the line of sight: along it, captured points tremble.
double move_across_mm(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

// How sure each of the points is to rest on the floor, least..1: those by which their foot is lowest, the nearer the
// floor and the stiller, across the line of sight, since `previous`, one frame ago. nullptr: least.
std::vector<double> standing(std::span<const SolePoint> soles, const Skeleton& skeleton, const Floor& floor,
                             const Pose& pose, const Pose* previous, double least = 0);

struct FloorOptions {
  double memory = 1000;  // after so many resting feet one's say has fallen to 1/e
  // Resting feet before the floor is known; until more places are it is upright to the room's edges and the body.
  double least = 2;
  double early = 60;  // until so many have rested, every frame is asked for its feet (twice as many frames at most),
  int every = 5;      // then one in so many
  double tilt_deviation = 0.06;  // rad, of the floor against what a body stands upright on
  // mm, of a resting foot's height, for how firmly what is upright holds the tilt against feet: their depths are off
  // for many frames alike, which counts as if one was off by more.
  double height_deviation_mm = 90;
  // A foot so far from the floor has half a say (Cauchy); one three times as far is not on it, and has none in balance.
  double outlier_mm = 30;
  // After more than so many frames on end in which no resting foot is within three times that: another floor.
  int max_contradicted_frames = 30;
  // A foot so much higher than the other has half a say, however that one moves: the floor is below both, and a foot
  // that is lifted is as still where it is highest as one that stands.
  double higher_foot_mm = 25;
  // Feet beyond it are believed to be where it ends, on their lines of sight; and how much of the height it tells.
  BalanceOptions balance;

  void validate() const;  // throws ConfigError
};

// A plane through the resting feet of the frames so far, where balance has them, and by BalanceOptions::share nearer to
// where who stands on it would be in balance; where they do not tell its tilt, below
// what is upright: the room's edges, and the body from ankles to neck, as that was on average. A floor that was
// measured stays what it is.
class FloorFinder {
 public:
  // Keeps a reference to the actor. Throws ConfigError.
  FloorFinder(const Actor& actor, const FloorOptions& options, const std::optional<Floor>& measured);

  // Whether the next learn() asks where the feet are.
  bool asks_for_feet() const;
  // Two poses that are believed, a frame apart; feet whose ankles were not seen tell nothing. `pose` tells what rests,
  // and of balance once a floor holds it. feet: `pose`, or one with
  // the legs where the picture alone has them: a floor that holds feet would only learn where it holds them. nullptr:
  // not known.
  void learn(const Pose& previous, const Pose& pose, const Pose* feet, const Detections& detections);
  void forget();
  // By the room's edges. It stays so.
  void set_upright(const Upright& upright) { upright_ = upright; }

  // Unit, camera frame: out of the floor, or while it is not known the way of what is upright. Where nothing is, a
  // camera stands level.
  Eigen::Vector3d up() const;

  // How much farther from the camera, along the floor, the feet of `pose` are than those of who is in balance
  // (BalanceOptions::middle_mm). nullopt of who does not stand, or is seen from too far above to tell.
  std::optional<double> beyond_balance_mm(const Pose& pose) const;

  // A measured floor on which no foot has rested for so long that a learned one would have been forgotten: the camera
  // was moved, or it is another camera's. It stays so.
  bool is_contradicted() const { return is_measured_ && contradicted_frames_ > options_.max_contradicted_frames; }

  // nullptr while it is not known; a measured one is from the beginning.
  const Floor* floor() const { return floor_ ? &*floor_ : nullptr; }

 private:
  std::optional<Eigen::Vector3d> middle_of(const std::vector<Eigen::Vector3d>& soles_mm) const;
  std::vector<Eigen::Vector3d> balanced(const PosedSkeleton& feet, const Eigen::Vector3d& up,
                                        std::vector<Eigen::Vector3d> soles_mm);
  void learn_balance(const std::array<Eigen::Vector3d, kKeypointCount>& joints, const Eigen::Vector3d& up,
                     const std::vector<Eigen::Vector3d>& before_mm, const std::vector<Eigen::Vector3d>& soles_mm);
  void add(const Eigen::Vector3d& point_mm, double weight);
  void fit();
  struct Tilt {
    Eigen::Vector2d slope = Eigen::Vector2d::Zero();        // of a level plane y = slope . (x, z)
    Eigen::Matrix2d information = Eigen::Matrix2d::Zero();  // 1/rad^2
  };
  Tilt tilt() const;

  const Actor& actor_;
  FloorOptions options_;
  std::vector<SolePoint> soles_;
  std::optional<Upright> upright_;
  Balance balance_;
  SoleInBalance in_balance_;
  Eigen::Vector3d body_up_ = Eigen::Vector3d::Zero();   // sum
  Eigen::Matrix3d products_ = Eigen::Matrix3d::Zero();  // of (1, x, z), m
  Eigen::Vector3d sums_ = Eigen::Vector3d::Zero();      // of y (1, x, z)
  double n_resting_ = 0;                                // that its memory holds
  int n_asked_ = 0, frames_since_asked_ = 0;            // frames
  int contradicted_frames_ = 0;
  const bool is_measured_;
  std::optional<Floor> floor_;
};

}  // namespace livecap
