// The built-in actors' bones: skin weights, forward kinematics and dual quaternion skinning (Kavan et al. 2008).
//
// Every bone frame is parallel to the rest frame in the bind pose. Written apart from the tracker's skinning on
// purpose.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "meshing/actor_glb.h"
#include "synth/body_shape.h"

namespace livecap::synth {

using meshing::Influence;
using meshing::Influences;
using meshing::Surface;

// Smooth weights from the distance to each bone that may move the part, diffused over the surface. Shape units.
std::vector<Influences> make_skin_weights(const BodyShape& shape, const Surface& surface,
                                          const std::vector<Part>& parts);

struct BonePose {
  std::array<Eigen::Quaterniond, kBoneCount> rotations;  // rest frame -> posed, of each bone
  std::array<Vec3, kBoneCount> origins;                  // where its joint is
};

// local[b]: rotation of bone b relative to its parent; root_position: where the hips are.
BonePose pose_bones(const std::array<Vec3, kBoneCount>& rest_joints,
                    const std::array<Eigen::Quaterniond, kBoneCount>& local, const Vec3& root_position);

std::vector<Vec3> skin_vertices(const std::vector<Vec3>& rest, const std::vector<Influences>& weights,
                                const std::array<Vec3, kBoneCount>& rest_joints, const BonePose& pose);

// Neighbours of each vertex, ascending.
std::vector<std::vector<int>> vertex_neighbors(const Surface& surface);

}  // namespace livecap::synth
