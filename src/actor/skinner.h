// Dual quaternion skinning on a device: rest positions -> camera positions, displacements there and back, normals.
#pragma once

#include <span>
#include <vector>

#include "actor/actor.h"
#include "ocl/buffer.h"
#include "ocl/kernel.h"

namespace livecap {

// All buffers are [3*n_vertices] float, mm. Work is enqueued in order; nothing blocks except set_pose's small upload.
class Skinner {
 public:
  // Keeps no reference to the actor.
  Skinner(ocl::DeviceContext& device, const Actor& actor)
      : Skinner(device, actor, actor.skin, actor.skeleton.n_bones()) {}
  // The same mesh with other weights on n_bones bones.
  Skinner(ocl::DeviceContext& device, const Actor& actor, const SkinWeights& skin, int n_bones);

  // dual_quats: [8*n_bones] of geometry/skeleton.h's bone_dual_quats.
  void set_pose(std::span<const float> dual_quats);

  // out_camera = DQS(rest + displacement_rest). Pass a zero buffer for the bare template.
  void skin(const ocl::Buffer<float>& displacement_rest, ocl::Buffer<float>& out_camera);

  // displacement_rest = share R^-1 (deformed - skinned), R the blended rotation of each vertex (paper, "Displacement
  // Warping"). share: [n_vertices] in 0..1, how much of a vertex's displacement is kept.
  void unskin_displacement(const ocl::Buffer<float>& deformed_camera, const ocl::Buffer<float>& skinned_camera,
                           const ocl::Buffer<float>& share, ocl::Buffer<float>& out_displacement_rest);

  // Area-weighted unit normals of camera positions.
  void normals(const ocl::Buffer<float>& positions_camera, ocl::Buffer<float>& out_normals);

  int n_vertices() const { return n_vertices_; }
  const ocl::Buffer<float>& rest_positions() const { return rest_; }

 private:
  friend class ActorSight;  // does the same in one launch with more
  ocl::Range over(int n) const;

  int n_vertices_ = 0;
  int lanes_ = 1;                       // rows of a work-item
  ocl::Buffer<float> rest_;             // [3*n] mm
  ocl::Buffer<int32_t> bones_;          // [4*n]
  ocl::Buffer<float> weights_;          // [4*n]
  ocl::Buffer<float> dual_quats_;       // [8*n_bones]
  ocl::Buffer<int32_t> fan_offsets_;    // [n+1] triangles around each vertex, compressed rows
  ocl::Buffer<int32_t> fan_triangles_;  // [3*sum] the three corners of each; on a CPU [sum] which they are
  // On a CPU each triangle's normal is worked out once.
  int n_triangles_ = 0;
  ocl::Buffer<int32_t> triangles_;
  ocl::Buffer<float> areas_;  // [4*n_triangles]
  ocl::Kernel triangle_normals_;
  ocl::Kernel skin_;
  ocl::Kernel unskin_;
  ocl::Kernel normals_;
};

// Known-answer tests of the skinning kernels against the double-precision reference.
std::vector<ocl::SelfTestResult> skinner_self_test(ocl::DeviceContext& device);

}  // namespace livecap
