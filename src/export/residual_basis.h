// The non-rigid motion for viewers that only know linear blend skinning: per frame the displacement of the bind pose
// that linear skinning carries to the captured surface, and the few shapes that span all of them (PCA).
#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>

#include "actor/actor.h"

namespace livecap {

// Linear blend skinning of an actor in the glTF frame. Units: metres.
class LinearSkinning {
 public:
  explicit LinearSkinning(const Actor& actor);

  void set_pose(const Pose& pose);
  // Captured position of bind + displacement, and the displacement that gives a captured position. All metres.
  Eigen::Vector3d forward(int vertex, const Eigen::Vector3d& displacement) const;
  Eigen::Vector3d inverse(int vertex, const Eigen::Vector3d& captured) const;

 private:
  const Actor& actor_;
  std::vector<Eigen::Matrix<double, 3, 4>> bones_;    // gltf_from_bind of each bone, metres
  std::vector<Eigen::Matrix<double, 3, 4>> blended_;  // per vertex
};

// Shapes as columns with largest entry 1, [3n x k], k <= max_shapes. `residual(i, column)` fills sample i of n_samples.
// Shapes that would move no sample by more than tolerance_m (root mean square) are left out.
Eigen::MatrixXf residual_basis(int n_numbers, int n_samples, int max_shapes, double tolerance_m,
                               const std::function<void(int sample, Eigen::Ref<Eigen::VectorXd> column)>& residual);

}  // namespace livecap
