// A state of the unknowns as the row kernels read it, and what the device needs to make the same of it itself
// (kernels/pose/chain.h); kernels/pose/layout.h says where everything lies.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "actor/actor.h"
#include "geometry/skeleton.h"
#include "pose/floor.h"
#include "pose/layout.h"

namespace livecap {

// Unknowns in this order everywhere: [root rotation vector 3 | t 3 | joint angles n_dofs | t' 3].
struct PoseState {
  Pose pose;
  Eigen::Vector3d t_prime_mm = Eigen::Vector3d::Zero();
};

// The chain and the points on it.
struct PosePoints {
  Skeleton skeleton;
  std::array<KeypointAnchor, kKeypointCount> keypoints;
  std::vector<SolePoint> soles;
};

// out: [LC_POSE_STEP_SIZE].
void write_step(const PoseLayout& layout, const PosePoints& points, const PoseState& state, std::span<float> out);

// [LC_POSE_CHAIN_SIZE]
std::vector<double> chain_constants(const PoseLayout& layout, const PosePoints& points);
// Parents, bones of joints, bones of points.
std::vector<int32_t> chain_links(const PosePoints& points);

// [LC_POSE_STATE_SIZE], and back.
std::vector<double> state_values(const PoseState& state);
PoseState state_of(std::span<const double> values);

}  // namespace livecap
