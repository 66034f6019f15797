// A person's proportions as thirteen numbers, and what they make of an actor's bones and surface: `actor fit` finds
// them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "actor/actor.h"

namespace livecap {

enum Proportion : int {
  kTrunkLength,
  kTrunkGirth,
  kHeadSize,
  kShoulderWidth,  // length of the clavicles
  kUpperArmLength,
  kUpperArmGirth,
  kForearmLength,  // with the hand
  kForearmGirth,
  kThighLength,
  kThighGirth,
  kShankLength,
  kShankGirth,
  kFootSize,
  kProportionCount
};

extern const std::array<const char*, kProportionCount> kProportionNames;

// Logarithms of the scales against the actor they are applied to; left and right share them.
using Proportions = Eigen::Matrix<double, kProportionCount, 1>;

// The actor of other proportions: each bone is stretched along and around itself, the surface follows its skin weights.
struct Shape {
  std::vector<Eigen::Vector3d> joints;   // [n_bones] mm, rest frame, before the soles are put on the floor
  std::vector<Eigen::Matrix3d> stretch;  // [n_bones]
  Skeleton skeleton;
};

// The actor must outlive it and have LiveCap's bones.
class Reshaper {
 public:
  explicit Reshaper(const Actor& actor);

  Shape shape(const Proportions& proportions) const;
  // Where a rest point goes that is fixed to a bone.
  Eigen::Vector3d attached(const Shape& shape, int bone, const Eigen::Vector3d& point) const;
  // Where a vertex of the template goes, mm, rest frame.
  Eigen::Vector3d vertex(const Shape& shape, int index) const;

 private:
  const Actor& actor_;
  std::vector<Eigen::Vector3d> joints_;          // [n_bones] at rest
  std::vector<Eigen::Vector3d> axes_;            // [n_bones] unit, along the bone; zero where it has none
  std::vector<Eigen::Matrix3d> rest_from_bone_;  // [n_bones] rotation
};

}  // namespace livecap
