// The signed distance field of image/silhouette.h on the device: kernels/image/distance_field.cl. compute() gives the
// same numbers as make_silhouette().
#pragma once

#include "image/person_gate.h"
#include "ocl/buffer.h"
#include "ocl/kernel.h"

namespace livecap {

class DeviceDistanceField {
 public:
  // Throws ConfigError for a size that is not in 1..16000.
  DeviceDistanceField(ocl::DeviceContext& device, int width, int height);

  // mask: [w*h] nonzero = person; person: the box around all of it, not empty; area_px: its pixels. distance: [w*h] px,
  // see Silhouette::signed_distance. Enqueued, nothing blocks. Throws LogicError for other sizes.
  void compute(const ocl::Buffer<uint8_t>& mask, const PixelBox& person, int area_px, ocl::Buffer<float>& distance);

  // The contour may be anywhere between those of two masks. distance, of the larger, stays what it is outside of that;
  // inside of the smaller it becomes `sure`, the distance of that one, and between them zero. Enqueued. Throws
  // LogicError for other sizes.
  void leave_open(const ocl::Buffer<float>& sure, ocl::Buffer<float>& distance);

 private:
  int width_, height_;
  int stride_;
  bool is_cpu_;
  // Planes and rows of blocks, see the kernels. CPU:
  ocl::Buffer<uint16_t> steps_;
  ocl::Buffer<int32_t> row_scratch_;
  // GPU:
  ocl::Buffer<uint32_t> bits_;
  ocl::Buffer<int32_t> far_to_inside_, far_to_outside_;
  ocl::Kernel bits_kernel_, columns_, rows_, extend_, leave_open_;
};

}  // namespace livecap
