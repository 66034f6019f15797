#include "cloth/hanging_cloth.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "cloth/folds.h"
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

// What hanging cloth's weights on the legs, which sum to `legs`, should have summed to in stage I.
float trusted_legs(const Actor& actor, float legs, const HangingClothOptions& options) {
  return actor.guessed_weights ? std::pow(legs, options.guessed_power) : legs;
}

// The actor's weights with what hanging cloth has too many on the legs given to hanging_bone. kept(L): which share of
// its weights on the legs a vertex keeps where they sum to L.
SkinWeights give_to_hanging_bone(const Actor& actor, const std::function<float(float)>& kept, int hanging_bone) {
  SkinWeights out = actor.skin;
  const std::vector<char> leg = leg_bones(actor.skeleton);
  const std::vector<float> leg_weight = leg_weights(actor);
  std::vector<std::pair<float, int>> influences;
  for (int i = 0; i < actor.n_vertices(); ++i) {
    if (!hangs(actor, i)) continue;
    const float legs = leg_weight[i];
    const float scale = legs > 0 ? kept(legs) : 1;
    if (scale == 1) continue;
    influences = {{(1 - scale) * legs, hanging_bone}};
    for (int k = 4 * i; k < 4 * i + 4; ++k) {
      const int bone = actor.skin.bones[k];
      const float weight = (leg[bone] ? scale : 1) * actor.skin.weights[k];
      if (bone == hanging_bone)
        influences.front().first += weight;
      else
        influences.emplace_back(weight, bone);
    }
    set_strongest(out, i, influences);
  }
  return out;
}

}  // namespace

void set_strongest(SkinWeights& weights, int vertex, std::vector<std::pair<float, int>> influences) {
  std::stable_sort(influences.begin(), influences.end(), [](auto& a, auto& b) { return a.first > b.first; });
  influences.resize(kMaxInfluences);
  float sum = 0;
  for (const auto& [weight, bone] : influences) sum += weight;
  for (int k = 0; k < kMaxInfluences; ++k) {
    const bool used = influences[k].first > 0;
    weights.bones[kMaxInfluences * vertex + k] = used ? influences[k].second : 0;
    weights.weights[kMaxInfluences * vertex + k] = used ? influences[k].first / sum : 0;
  }
}

std::optional<Eigen::Vector3d> middle_of_the_hips(const Skeleton& skeleton) {
  const int left = skeleton.bone_index("left_hip"), right = skeleton.bone_index("right_hip");
  if (left < 1 || right < 1) return std::nullopt;
  const PosedSkeleton rest = forward_kinematics(skeleton, rest_pose(skeleton));
  return (rest.camera_from_bone[left].translation() + rest.camera_from_bone[right].translation()) / 2;
}

SkinWeights hanging_weights(const Actor& actor, const HangingClothOptions& options) {
  options.validate();
  const float c = std::lerp(options.taut_leg_share, options.loose_leg_share, looseness(actor, options));
  const auto kept = [&](float legs) {
    const float trusted = trusted_legs(actor, legs, options);
    return c / (c + (1 - c) * trusted) * (trusted / legs);
  };
  return give_to_hanging_bone(actor, kept, bone_of_the_hips(actor.skeleton).value_or(0));
}

std::vector<float> trusted_leg_weights(const Actor& actor, const HangingClothOptions& options) {
  std::vector<float> sums = leg_weights(actor);
  for (int i = 0; i < actor.n_vertices(); ++i)
    if (hangs(actor, i)) sums[i] = trusted_legs(actor, sums[i], options);
  return sums;
}

std::vector<float> leg_weights(const Actor& actor) {
  const std::vector<char> leg = leg_bones(actor.skeleton);
  std::vector<float> sums(actor.n_vertices(), 0.0f);
  for (size_t k = 0; k < actor.skin.bones.size(); ++k) {
    if (leg[actor.skin.bones[k]]) sums[k / kMaxInfluences] += actor.skin.weights[k];
  }
  return sums;
}

float looseness(const Actor& actor, const HangingClothOptions& options) {
  options.validate();
  const float folds = float(share_in_folds(actor));
  return std::clamp((folds - options.taut) / (options.loose - options.taut), 0.0f, 1.0f);
}

void HangingClothOptions::validate() const {
  const auto require_share = [](float value, const char* field) {
    if (!(value > 0.0f && value <= 1.0f))
      throw ConfigError(std::string("hanging cloth: ") + field + " is " + std::to_string(value) +
                        ", must be above 0 and at most 1");
  };
  require_share(taut_leg_share, "taut_leg_share");
  require_share(loose_leg_share, "loose_leg_share");
  if (!(taut >= 0.0f && taut < loose && std::isfinite(loose))) {
    throw ConfigError("hanging cloth: taut is " + std::to_string(taut) + " and loose " + std::to_string(loose) +
                      "; they must be at least 0, and taut the less");
  }
  const auto require_power = [](float value, const char* field) {
    if (!(value >= 1.0f && std::isfinite(value)))
      throw ConfigError(std::string("hanging cloth: ") + field + " is " + std::to_string(value) +
                        ", must be at least 1 and finite");
  };
  require_power(guessed_power, "guessed_power");
  require_power(carried_power, "carried_power");
  if (!(gravity_share >= 0.0f && gravity_share <= 1.0f)) {
    throw ConfigError("hanging cloth: gravity_share is " + std::to_string(gravity_share) + ", must be from 0 to 1");
  }
}

HangingCloth::HangingCloth(const Actor& actor, const HangingClothOptions& options) : options_(options) {
  options.validate();
  const auto kept = [&](float legs) { return std::min(1.0f, std::pow(legs, options.carried_power) / legs); };
  weights_ = give_to_hanging_bone(actor, kept, actor.skeleton.n_bones());
  const std::optional<Eigen::Vector3d> pivot = middle_of_the_hips(actor.skeleton);
  if (!pivot) return;
  pivot_rest_ = *pivot;
  base_ = *bone_of_the_hips(actor.skeleton);
}

std::vector<float> HangingCloth::dual_quats(PosedSkeleton posed, const Eigen::Vector3d& up) const {
  Eigen::Isometry3d bone = posed.camera_from_rest[base_];
  // The template's downward axis against straight down; a body that lies or hangs upside down is left as it is.
  const Eigen::Vector3d body_down = -bone.linear().col(1), down = -up;
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
