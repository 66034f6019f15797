// apply_physique of actor_model.h: other proportions by moving the rest surface with its bones.
#include <algorithm>

#include "base/text.h"
#include "livecap/error.h"
#include "synth/actor_model.h"

namespace livecap {

void Physique::validate() const {
  for (const auto& [name, value] : {std::pair{"legs", legs}, std::pair{"arms", arms}, std::pair{"trunk", trunk},
                                    std::pair{"shoulders", shoulders}, std::pair{"girth", girth}})
    if (!(value >= 0.6 && value <= 1.6))
      throw ConfigError(format("synth: --%s %g: must be between 0.6 and 1.6", name, value));
}

namespace synth {

namespace {

// Stretch by `along` in the direction of `axis` and by `across` around it.
Eigen::Matrix3d stretch(const Vec3& axis, double along, double across) {
  const Vec3 a = axis.normalized();
  return across * Eigen::Matrix3d::Identity() + (along - across) * a * a.transpose();
}

}  // namespace

void apply_physique(const Physique& physique, ActorModel& actor) {
  physique.validate();
  if (physique.legs == 1 && physique.arms == 1 && physique.trunk == 1 && physique.shoulders == 1 && physique.girth == 1)
    return;  // not a bit changes
  const auto before = actor.joints;
  double height = 0;  // the soles are at 0
  for (const Vec3& p : actor.surface.vertices) height = std::max(height, p.y());
  std::array<Eigen::Matrix3d, kBoneCount> map;
  map.fill(Eigen::Matrix3d::Identity());
  for (int bone : {kHips, kSpine, kSpine1, kSpine2}) map[bone] = stretch(Vec3::UnitY(), physique.trunk, physique.girth);
  for (int shift : {0, kRightShoulder - kLeftShoulder}) {
    const auto direction = [&](int from, int to) { return Vec3(before[to + shift] - before[from + shift]); };
    map[kLeftShoulder + shift] = physique.shoulders * Eigen::Matrix3d::Identity();
    map[kLeftArm + shift] = stretch(direction(kLeftArm, kLeftForeArm), physique.arms, physique.girth);
    map[kLeftForeArm + shift] = stretch(direction(kLeftForeArm, kLeftHand), physique.arms, physique.girth);
    map[kLeftUpLeg + shift] = stretch(direction(kLeftUpLeg, kLeftLeg), physique.legs, physique.girth);
    map[kLeftLeg + shift] = stretch(direction(kLeftLeg, kLeftFoot), physique.legs, physique.girth);
  }
  for (int bone = 1; bone < kBoneCount; ++bone) {
    const int parent = kBones[bone].parent;
    actor.joints[bone] = actor.joints[parent] + map[parent] * (before[bone] - before[parent]);
  }
  double top = -1e9, bottom = 1e9;
  for (size_t i = 0; i < actor.surface.vertices.size(); ++i) {
    Vec3 moved = Vec3::Zero();
    for (const Influence& influence : actor.weights[i])
      moved += influence.weight * (actor.joints[influence.bone] +
                                   map[influence.bone] * (actor.surface.vertices[i] - before[influence.bone]));
    actor.surface.vertices[i] = moved;
    top = std::max(top, moved.y()), bottom = std::min(bottom, moved.y());
  }
  const double scale = height / (top - bottom);
  for (Vec3& p : actor.surface.vertices) p = scale * (p - Vec3(0, bottom, 0));
  for (Vec3& p : actor.joints) p = scale * (p - Vec3(0, bottom, 0));
}

}  // namespace synth
}  // namespace livecap
