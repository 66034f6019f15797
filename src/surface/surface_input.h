// What stage II gets: one prepared frame and the buffers that skinning and rasterisation left on the device.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "image/device_frame.h"
#include "ocl/buffer.h"

namespace livecap {

// Camera frame, mm, mesh vertex order. All buffers belong to the solver's DeviceContext and outlive the call.
struct SurfaceInput {
  const DeviceFrame& frame;           // of the camera's size
  const ocl::Buffer<float>& skinned;  // [3n] V^S
  const ocl::Buffer<float>& start;    // [3n] V^S + d^S, the warped displacement added, or see `continues`
  // Null: no E_velocity, no E_acceleration. What the last frame predicts for this one: V^S + d^S of t-1, not V^{t-1}.
  const ocl::Buffer<float>* previous = nullptr;
  // [3n] likewise of t-2; null: no E_acceleration.
  const ocl::Buffer<float>* before_previous = nullptr;
  // [LC_MATCH*n] what a TextureMatcher found from `start`; null: no E_match.
  const ocl::Buffer<float>* matches = nullptr;
  // The frame of the launch before: `start` is where that ended, and its failure is the frame's.
  bool continues = false;
  const ocl::Buffer<int>& visible;                   // [n] not 0: takes part in E_photo
  const ocl::Buffer<int>& contour_flag;              // [n] not 0: takes part in E_silhouette
  const ocl::Buffer<float>& normals;                 // [3n] outward, of start
  const ocl::Buffer<uint8_t>* part_image = nullptr;  // [w*h] dilated body-part mask, 0 = none; null: no masking
  const ocl::Buffer<int>* vertex_part = nullptr;     // [n] value of each vertex's part in part_image
};

struct SurfaceOptions {
  float w_photo = 1e4f;  // colours in [0,1]; a weight of 0 switches its term off
  // px. The paper's 600 with few iterations leaves loose cloth short of the outline: with 4000 and 12 PCG iterations
  // the mean IoU rose by 0.001 to 0.02 on the three sequences with ground truth it was tried on, the vertex error
  // stayed.
  float w_silhouette = 4000.0f;
  float w_match = 1000.0f;      // px. Times the correlation of the two patches, or ClothBehind's share
  float constant_rigidity = 0;  // > 0: s_ij of every edge, instead of its vertices' labels'
  float w_smooth = 10.0f;       // mm, as the following
  float w_edge = 30.0f;
  // Of what does not hang (actor.h:hangs). Nearly a constraint: from 5 on, captures hardly differ.
  float w_depth = 30.0f;
  float w_velocity = 0.25f;  // of what hangs
  // Of what does not: skin and worn cloth keep the displacement that they need, while the outline trembles.
  float w_worn_velocity = 10.0f;
  // The paper: 0.1. Cloth that follows the legs trembles as they do.
  float w_acceleration = 1.0f;
  std::vector<int> gaussian_kernels = {15, 9, 3};  // odd, 1..15; one Gauss-Newton step each
  // The paper's 4 end long before the minimum.
  int pcg_iterations = 12;
  // The length that E_edge draws an edge to: 1 = that of the rest pose (the paper), 0 = that of the skinned template.
  // Skinning stretches clothes on the body as the body does, and there E_edge with rest lengths works against E_smooth.
  // Half is a compromise between sequences, not a property of cloth.
  float edge_rest_share = 0.5f;
  // The same of edges both of whose ends hang: woven cloth hardly stretches.
  float hanging_rest_share = 0.8f;
  // sigma_c: photometric residuals longer than this (Euclidean, RGB in [0,1]) are zero. The paper gives no value. At
  // the true vertices of lit pictures a third of the residuals of striped cloth exceeded 0.2, and without them the
  // gradient no longer pointed to the truth.
  float color_threshold = 0.5f;
  float damping = 1e-3f;      // added to the diagonal of J^T J; the weakest regulariser is 0.1
  float max_step_mm = 50.0f;  // no vertex moves farther in one Gauss-Newton step

  // Throws ConfigError naming the field.
  void validate() const;
};

struct SurfaceEnergies {
  double photo = 0;
  double silhouette = 0;  // sum of w r^2 over contour vertices with b_i != 0
  double match = 0;
  double smooth = 0;
  double edge = 0;
  double depth = 0;
  double velocity = 0;
  double acceleration = 0;
  double total() const { return photo + silhouette + match + smooth + edge + depth + velocity + acceleration; }
};

enum class SurfaceStatus {
  kOk,
  kNonFinite,  // a step was not finite: the start is given back
};

}  // namespace livecap
