// The small rigged figure of tests/actor with a random motion and a captured surface that leaves its skinning.
#pragma once

#include <Eigen/Geometry>
#include <random>
#include <vector>

#include "actor/actor.h"
#include "actor/glb_fixture.h"
#include "geometry/skeleton.h"

namespace livecap::test {

inline Actor small_actor() {
  return load_actor_bytes(make_fixture().bytes, "figure");
}

// Smooth poses within the limits, some metres before the camera and upright in it.
inline std::vector<Pose> smooth_motion(const Skeleton& skeleton, int n_frames, unsigned seed = 3) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  Eigen::VectorXd phase(skeleton.n_dofs()), speed(skeleton.n_dofs());
  for (int k = 0; k < skeleton.n_dofs(); ++k) {
    phase[k] = 6.28 * uniform(rng);
    speed[k] = 0.02 + 0.1 * uniform(rng);
  }
  std::vector<Pose> poses;
  for (int frame = 0; frame < n_frames; ++frame) {
    Pose pose;
    pose.root_rotation =
        Eigen::AngleAxisd(3.14159265 + 0.1 * std::sin(0.1 * frame), Eigen::Vector3d::UnitX()).toRotationMatrix() *
        Eigen::AngleAxisd(0.05 * frame, Eigen::Vector3d::UnitY()).toRotationMatrix();
    pose.root_translation_mm = {200 * std::sin(0.07 * frame), -100 + 2.0 * frame, 3200 + 5.0 * frame};
    pose.angles_rad.resize(skeleton.n_dofs());
    for (int k = 0; k < skeleton.n_dofs(); ++k) {
      const Dof& dof = skeleton.dofs[k];
      pose.angles_rad[k] =
          dof.min_rad + (dof.max_rad - dof.min_rad) * (0.5 + 0.35 * std::sin(phase[k] + speed[k] * frame));
    }
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace livecap::test
