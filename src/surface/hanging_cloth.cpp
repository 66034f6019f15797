#include "surface/hanging_cloth.h"

#include <algorithm>
#include <string>
#include <utility>

#include "livecap/error.h"

namespace livecap {
namespace {

constexpr float kHangingRigidity = 1.0f;

// For every bone of a leg the bone that leg hangs from, else -1.
std::vector<int> leg_bases(const Skeleton& skeleton) {
  std::vector<int> base(skeleton.n_bones(), -1);
  for (int b = 1; b < skeleton.n_bones(); ++b) {
    const int parent = skeleton.bones[b].parent;
    const std::string& name = skeleton.bones[b].name;
    if (base[parent] >= 0) {
      base[b] = base[parent];
    } else if (name == "left_hip" || name == "right_hip") {
      base[b] = parent;
    }
  }
  return base;
}

}  // namespace

SkinWeights hanging_cloth_weights(const Actor& actor, float leg_share) {
  if (!(leg_share > 0.0f && leg_share <= 1.0f)) {
    throw ConfigError("surface option leg_share is " + std::to_string(leg_share) +
                      ": it must be above 0 and at most 1");
  }
  SkinWeights out = actor.skin;
  const std::vector<int> base = leg_bases(actor.skeleton);
  std::vector<std::pair<float, int>> influences;
  for (int i = 0; i < actor.n_vertices(); ++i) {
    if (actor.rigidity[i] > kHangingRigidity) continue;
    float legs = 0;
    for (int k = 4 * i; k < 4 * i + 4; ++k) {
      if (base[actor.skin.bones[k]] >= 0) legs += actor.skin.weights[k];
    }
    if (legs <= 0 || leg_share == 1) continue;
    const float scale = leg_share / (leg_share + (1 - leg_share) * legs);
    influences.clear();
    const auto add = [&](float weight, int bone) {
      for (auto& [sum, b] : influences) {
        if (b != bone) continue;
        sum += weight;
        return;
      }
      influences.emplace_back(weight, bone);
    };
    for (int k = 4 * i; k < 4 * i + 4; ++k) {
      const float weight = actor.skin.weights[k];
      const int bone = actor.skin.bones[k];
      if (weight <= 0) continue;
      const float kept = base[bone] >= 0 ? scale * weight : weight;
      add(kept, bone);
      if (kept < weight) add(weight - kept, base[bone]);
    }
    std::stable_sort(influences.begin(), influences.end(), [](auto& a, auto& b) { return a.first > b.first; });
    if (influences.size() > kMaxInfluences) influences.resize(kMaxInfluences);
    float sum = 0;
    for (const auto& [weight, bone] : influences) sum += weight;
    for (size_t k = 0; k < kMaxInfluences; ++k) {
      const bool used = k < influences.size() && influences[k].first > 0;
      out.bones[4 * i + k] = used ? influences[k].second : 0;
      out.weights[4 * i + k] = used ? influences[k].first / sum : 0;
    }
  }
  return out;
}

}  // namespace livecap
