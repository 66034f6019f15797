// Body-part mask (paper, "Stage II"): which part of the body each pixel shows, grown so that small gaps between parts
// close, the torso over the others. A contour vertex over another part's region takes no silhouette constraint (b_i =
// 0).
#pragma once

#include <string_view>
#include <vector>

#include "actor/actor.h"
#include "ocl/buffer.h"
#include "ocl/kernel.h"
#include "raster/depth.h"

namespace livecap {

// Ids in the part image and the vertex list. Left and right are the subject's.
enum BodyPart : int { kNoPart, kTorso, kLeftArm, kRightArm, kLeftLeg, kRightLeg, kHead, kBodyPartCount };

// Part of each bone by its name (the words of docs/formats.md: left_shoulder, right_hip, neck ...); a bone whose name
// says nothing belongs to its parent's part, the root and the clavicles to the torso. [n_bones]
std::vector<int32_t> body_parts_of_bones(const Skeleton& skeleton);

// Part of each vertex: that of the bone with the largest weight. [n_vertices]
std::vector<int32_t> body_parts_of_vertices(const Skeleton& skeleton, const SkinWeights& skin);

class PartMask {
 public:
  static constexpr int kDefaultDilationPx = 10;

  // vertex_part: [n_vertices] BodyPart ids in 1..6. dilation_px in 0..15: half the side of the square each part grows
  // by. Throws ConfigError / LogicError.
  PartMask(ocl::DeviceContext& device, const Mesh& mesh, const std::vector<int32_t>& vertex_part, int width, int height,
           int dilation_px = kDefaultDilationPx);

  // From what `raster` rendered last (in a capture the template with the last frame's displacement). Enqueued in order,
  // nothing blocks.
  void update(const DepthRasterizer& raster);

  const ocl::Buffer<uint8_t>& part_image() const { return part_image_; }    // [w*h] BodyPart, 0 = none
  const ocl::Buffer<int32_t>& vertex_part() const { return vertex_part_; }  // [n_vertices] BodyPart

 private:
  int width_;
  int height_;
  int dilation_px_;
  int stride_;
  int n_groups_;
  ocl::Buffer<int32_t> vertex_part_;
  ocl::Buffer<int32_t> triangle_part_;  // [n_triangles]
  ocl::Buffer<uint8_t> bits_;           // padded planes of kernels/raster/part_mask.cl
  ocl::Buffer<uint8_t> grown_;
  ocl::Buffer<uint8_t> part_image_;
  ocl::Kernel bits_kernel_;
  ocl::Kernel rows_kernel_;
  ocl::Kernel columns_kernel_;
};

}  // namespace livecap
