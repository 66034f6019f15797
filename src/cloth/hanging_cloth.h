// How cloth that hangs from the waist follows the body. Its skinning weights come from the nearest leg, but it is not
// fastened there: when a thigh moves forward, the back of a skirt stays hanging. In stage I the outline of a
// skirt must not turn the legs as if they were what is seen. In stage II E_smooth keeps the surface close to the
// skinned one wherever the picture says nothing, so V^S must not carry the back along.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "actor/actor.h"

namespace livecap {

struct HangingClothOptions {
  // In stage I a vertex whose weights on the legs sum to L keeps c L / (c + (1 - c) L) of them, c in (0,1]:
  // all of a small L, c of L = 1. The rest goes to the hanging bone. 1 = the actor's own skinning (the paper). Loose
  // cloth lies on the legs; what is taut stands away from them (ClothSimulation), and moves once they touch it.
  float taut_leg_share = 0.1f, loose_leg_share = 0.4f;
  // Where the actor's weights are guessed, L to this power stands for L in stage I: heat lets cloth near the hips
  // follow the legs two to three times as far as it does.
  float guessed_power = 2;
  // In stage II L to this power stands for L: cloth hangs where the legs do not push it (ClothSimulation), and only
  // what lies all on them goes where they go.
  float carried_power = 4;
  // Cloth with less than `taut` of it in folds (cloth/folds.h) is taut, with `loose` or more it is loose.
  float taut = 0.10f;
  float loose = 0.13f;
  // The hanging bone is the bone the legs hang from, turned this far towards what is straight down (0..1): pelvis tilt
  // is what a pose network sees worst.
  float gravity_share = 0.9f;

  void validate() const;  // throws ConfigError
};

// Between left_hip and right_hip in the rest pose, mm; nothing for a skeleton without them.
std::optional<Eigen::Vector3d> middle_of_the_hips(const Skeleton& skeleton);

// Gives a vertex the kMaxInfluences strongest of these (weight, bone), divided by their sum.
void set_strongest(SkinWeights& weights, int vertex, std::vector<std::pair<float, int>> influences);

// [n] sum of each vertex's weights on the legs (below and including the hips).
std::vector<float> leg_weights(const Actor& actor);

// 0 taut to 1 loose, by how much of the actor's hanging cloth lies in folds. Throws ConfigError.
float looseness(const Actor& actor, const HangingClothOptions& options);

// [n] leg_weights, of hanging cloth as far as stage I trusts them (guessed_power).
std::vector<float> trusted_leg_weights(const Actor& actor, const HangingClothOptions& options);

// As stage I has it: the hanging bone is the bone the legs hang from itself, since gravity is none of its unknowns.
// Throws ConfigError.
SkinWeights hanging_weights(const Actor& actor, const HangingClothOptions& options);

// As stage II has it. Only what hangs changes.
class HangingCloth {
 public:
  // Keeps no reference to the actor. A skeleton without left_hip and right_hip has nothing to change. Throws
  // ConfigError.
  HangingCloth(const Actor& actor, const HangingClothOptions& options);

  // What legs do not carry (carried_power) is on the hanging bone, bone n_bones.
  const SkinWeights& weights() const { return weights_; }

  // camera_from_rest of every bone and of the hanging bone as dual quaternions, [8*(n_bones+1)]. up: unit, camera
  // frame.
  std::vector<float> dual_quats(PosedSkeleton posed, const Eigen::Vector3d& up) const;

 private:
  HangingClothOptions options_;
  SkinWeights weights_;
  int base_ = 0;                                          // the bone the legs hang from
  Eigen::Vector3d pivot_rest_ = Eigen::Vector3d::Zero();  // mm, between the hips
};

}  // namespace livecap
