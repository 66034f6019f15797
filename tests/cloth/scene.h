// A skirt and two legs as small as they can be: an open cone around both legs of a mini-skeleton.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "actor/actor.h"

namespace livecap::test {

inline constexpr int kAround = 24, kRings = 14;
inline constexpr float kRingMm = 30;
inline constexpr float kSeamAboveHipsMm = 60;

// Rest frame: the middle of the hips is the origin, legs go down from 100 mm to either side, 400 mm to the knee and to
// the ankle.
inline Skeleton legs_only() {
  Skeleton skeleton;
  skeleton.bones = {{"pelvis", -1, {0, 0, 0}},       {"left_hip", 0, {100, 0, 0}},   {"left_knee", 1, {0, -400, 0}},
                    {"left_ankle", 2, {0, -400, 0}}, {"right_hip", 0, {-100, 0, 0}}, {"right_knee", 4, {0, -400, 0}},
                    {"right_ankle", 5, {0, -400, 0}}};
  skeleton.dofs = {{.name = "left_hip_x", .bone = 1, .axis = Eigen::Vector3d::UnitX(), .min_rad = -2, .max_rad = 2}};
  return skeleton;
}

// Ring 0 is the seam, above the hips and of another garment; below it each ring is 30 mm lower and 6 mm wider, and its
// leg weights grow from 0 by 0.1 a ring up to 0.8 (left and right by the side it is on). Triangles face outwards.
// finer: so many times as many vertices around it, and rings from one of these to the next.
inline Actor skirt_actor(int finer = 1) {
  Actor actor;
  actor.skeleton = legs_only();
  const int n_around = kAround * finer, n_rings = (kRings - 1) * finer + 1;
  for (int ring = 0; ring < n_rings; ++ring) {
    const float down = float(ring) / float(finer);
    for (int k = 0; k < n_around; ++k) {
      const double angle = 2 * M_PI * k / n_around, radius = 180 + 6.0 * down;
      const float x = float(radius * std::sin(angle)), z = float(radius * std::cos(angle));
      actor.mesh.positions.insert(actor.mesh.positions.end(), {x, kSeamAboveHipsMm - kRingMm * down, z});
      const float legs = std::min(0.1f * down, 0.8f);
      actor.skin.bones.insert(actor.skin.bones.end(), {x < 0 ? 4 : 1, 0, 0, 0});
      actor.skin.weights.insert(actor.skin.weights.end(), {legs, 1 - legs, 0, 0});
      actor.rigidity.push_back(ring == 0 ? 2.0f : 1.0f);
    }
  }
  for (int ring = 0; ring + 1 < n_rings; ++ring) {
    for (int k = 0; k < n_around; ++k) {
      const int a = ring * n_around + k, b = ring * n_around + (k + 1) % n_around, c = a + n_around, d = b + n_around;
      actor.mesh.triangles.insert(actor.mesh.triangles.end(), {a, c, b, b, c, d});
    }
  }
  actor.colors.assign(actor.mesh.positions.size(), 0.5f);
  return actor;
}

inline constexpr int kFineAround = 360;

// A cone around both legs whose radius at an angle t is r (1 + depth cos(folds t)), r as above; half of it hangs on the
// left leg. open: without its last tenth.
inline Actor folded_skirt(double depth, int folds, bool open = false) {
  Actor actor;
  actor.skeleton = legs_only();
  const int n_around = open ? kFineAround * 9 / 10 : kFineAround;
  for (int ring = 0; ring < kRings; ++ring) {
    for (int k = 0; k < n_around; ++k) {
      const double angle = 2 * M_PI * k / kFineAround;
      const double radius = (180 + 6.0 * ring) * (1 + depth * std::cos(folds * angle));
      actor.mesh.positions.insert(actor.mesh.positions.end(), {float(radius * std::sin(angle)), -30.0f * float(ring),
                                                               float(radius * std::cos(angle))});
      actor.skin.bones.insert(actor.skin.bones.end(), {1, 0, 0, 0});
      actor.skin.weights.insert(actor.skin.weights.end(), {0.5f, 0.5f, 0, 0});
      actor.rigidity.push_back(1.0f);
    }
  }
  for (int ring = 0; ring + 1 < kRings; ++ring) {
    for (int k = 0; k + (open ? 1 : 0) < n_around; ++k) {
      const int a = ring * n_around + k, b = ring * n_around + (k + 1) % n_around, c = a + n_around, d = b + n_around;
      actor.mesh.triangles.insert(actor.mesh.triangles.end(), {a, c, b, b, c, d});
    }
  }
  return actor;
}

inline Pose pose_of(const Skeleton& skeleton, double left_hip_rad = 0) {
  Pose pose = rest_pose(skeleton);
  pose.angles_rad[0] = left_hip_rad;
  return pose;
}

}  // namespace livecap::test
