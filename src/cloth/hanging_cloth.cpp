#include "cloth/hanging_cloth.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "livecap/error.h"

namespace livecap {
namespace {

// The bone the legs hang from.
std::optional<int> bone_of_the_hips(const Skeleton& skeleton) {
  const int left = skeleton.bone_index("left_hip"), right = skeleton.bone_index("right_hip");
  if (left < 1 || right < 1) return std::nullopt;
  return skeleton.bones[left].parent;
}

// Which bones are part of a leg.
std::vector<char> leg_bones(const Skeleton& skeleton) {
  std::vector<char> leg(skeleton.n_bones(), 0);
  for (int b = 1; b < skeleton.n_bones(); ++b) {
    const std::string& name = skeleton.bones[b].name;
    leg[b] = leg[skeleton.bones[b].parent] || name == "left_hip" || name == "right_hip";
  }
  return leg;
}

// The actor's weights with what hanging cloth has too many on the legs given to hanging_bone.
SkinWeights give_to_hanging_bone(const Actor& actor, float leg_share, int hanging_bone) {
  SkinWeights out = actor.skin;
  const std::vector<char> leg = leg_bones(actor.skeleton);
  const std::vector<float> leg_weight = leg_weights(actor);
  std::vector<std::pair<float, int>> influences;
  for (int i = 0; i < actor.n_vertices(); ++i) {
    if (!hangs(actor, i)) continue;
    const float legs = leg_weight[i];
    if (legs <= 0 || leg_share == 1) continue;
    const float scale = leg_share / (leg_share + (1 - leg_share) * legs);
    influences = {{(1 - scale) * legs, hanging_bone}};
    for (int k = 4 * i; k < 4 * i + 4; ++k) {
      const int bone = actor.skin.bones[k];
      const float weight = (leg[bone] ? scale : 1) * actor.skin.weights[k];
      if (bone == hanging_bone)
        influences.front().first += weight;
      else
        influences.emplace_back(weight, bone);
    }
    std::stable_sort(influences.begin(), influences.end(), [](auto& a, auto& b) { return a.first > b.first; });
    influences.resize(kMaxInfluences);
    float sum = 0;
    for (const auto& [weight, bone] : influences) sum += weight;
    for (size_t k = 0; k < kMaxInfluences; ++k) {
      const bool used = influences[k].first > 0;
      out.bones[4 * i + k] = used ? influences[k].second : 0;
      out.weights[4 * i + k] = used ? influences[k].first / sum : 0;
    }
  }
  return out;
}

}  // namespace

std::optional<Eigen::Vector3d> middle_of_the_hips(const Skeleton& skeleton) {
  const int left = skeleton.bone_index("left_hip"), right = skeleton.bone_index("right_hip");
  if (left < 1 || right < 1) return std::nullopt;
  const PosedSkeleton rest = forward_kinematics(skeleton, rest_pose(skeleton));
  return (rest.camera_from_bone[left].translation() + rest.camera_from_bone[right].translation()) / 2;
}

SkinWeights hanging_weights(const Actor& actor, const HangingClothOptions& options) {
  options.validate();
  return give_to_hanging_bone(actor, options.leg_share, bone_of_the_hips(actor.skeleton).value_or(0));
}

std::vector<float> leg_weights(const Actor& actor) {
  const std::vector<char> leg = leg_bones(actor.skeleton);
  std::vector<float> sums(actor.n_vertices(), 0.0f);
  for (size_t k = 0; k < actor.skin.bones.size(); ++k) {
    if (leg[actor.skin.bones[k]]) sums[k / kMaxInfluences] += actor.skin.weights[k];
  }
  return sums;
}

void HangingClothOptions::validate() const {
  if (!(leg_share > 0.0f && leg_share <= 1.0f)) {
    throw ConfigError("hanging cloth: leg_share is " + std::to_string(leg_share) + ", must be above 0 and at most 1");
  }
  if (!(gravity_share >= 0.0f && gravity_share <= 1.0f)) {
    throw ConfigError("hanging cloth: gravity_share is " + std::to_string(gravity_share) + ", must be from 0 to 1");
  }
}

HangingCloth::HangingCloth(const Actor& actor, const HangingClothOptions& options) : options_(options) {
  options.validate();
  weights_ = give_to_hanging_bone(actor, options.leg_share, actor.skeleton.n_bones());
  const std::optional<Eigen::Vector3d> pivot = middle_of_the_hips(actor.skeleton);
  if (!pivot) return;
  pivot_rest_ = *pivot;
  base_ = *bone_of_the_hips(actor.skeleton);
}

std::vector<float> HangingCloth::dual_quats(PosedSkeleton posed) const {
  Eigen::Isometry3d bone = posed.camera_from_rest[base_];
  // The template's downward axis against the picture's; a body that lies or hangs upside down is left as it is.
  const Eigen::Vector3d body_down = -bone.linear().col(1), down = Eigen::Vector3d::UnitY();
  const Eigen::Vector3d axis = body_down.cross(down);
  const double sine = axis.norm(), cosine = body_down.dot(down);
  if (sine > 1e-9 && cosine > 0) {
    const double angle = options_.gravity_share * cosine * std::atan2(sine, cosine);
    const Eigen::Vector3d pivot = bone * pivot_rest_;
    bone = Eigen::Translation3d(pivot) * Eigen::AngleAxisd(angle, axis / sine) * Eigen::Translation3d(-pivot) * bone;
  }
  posed.camera_from_rest.push_back(bone);
  return bone_dual_quats(posed);
}

}  // namespace livecap
