// Where hanging cloth that the camera does not see is to be: moved as the cloth before it
// (kernels/match/match_behind.cl).
#pragma once

#include "geometry/pinhole_arg.h"
#include "livecap/camera.h"
#include "ocl/buffer.h"
#include "ocl/kernel.h"
#include "raster/depth.h"

namespace livecap {

class ClothBehind {
 public:
  // camera: undistorted. share: what such a match counts of one that was seen, 0..1. Keeps a reference to the device
  // only.
  ClothBehind(ocl::DeviceContext& device, const Camera& camera, float share);

  // raster: rendered what `matches` [LC_MATCH*n_vertices] of a TextureMatcher were found from. start [3*n_vertices] mm,
  // camera frame: where the frame began; hangs [n_vertices] 1 or 0; visible [n_vertices]. Adds to the matches, for the
  // surface solver only. Enqueued. Throws LogicError for buffers of other sizes.
  void match(const DepthRasterizer& raster, const ocl::Buffer<float>& start, const ocl::Buffer<float>& hangs,
             const ocl::Buffer<int32_t>& visible, ocl::Buffer<float>& matches);

 private:
  PinholeArg camera_;
  float share_;
  ocl::Kernel match_behind_;
};

}  // namespace livecap
