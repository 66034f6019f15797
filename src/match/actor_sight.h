// All that a round of stage I sees of the actor, in one launch (kernels/match/see_actor.cl): what Skinner,
// DepthRasterizer, SurfaceVisibility, TextureMatcher and SkinShading launch one after the other, left where they leave
// it but for what was drawn. On GPUs whose work-groups can wait for each other and that have atomics of 64 bits.
#pragma once

#include "actor/skinner.h"
#include "geometry/pinhole_arg.h"
#include "image/device_frame.h"
#include "livecap/camera.h"
#include "match/skin_shading.h"
#include "match/texture_matcher.h"
#include "ocl/buffer.h"
#include "ocl/kernel.h"
#include "raster/depth.h"
#include "raster/visibility.h"

namespace livecap {

class ActorSight {
 public:
  // Of one actor; all must outlive this.
  ActorSight(ocl::DeviceContext& device, const Camera& camera, Skinner& skinner, DepthRasterizer& rasterizer,
             SurfaceVisibility& visibility, TextureMatcher& matcher, SkinShading& shading);

  bool usable() const { return usable_; }

  struct Look {
    int level = 0;             // 0..LC_MATCH_LEVELS, else LogicError
    bool new_picture = false;  // whether set_box() of another picture has been called since the last look
    bool shades = false;       // whether skin is measured
    const DeviceFrame& frame;
    const ocl::Buffer<float>& motions;  // [8*n_bones] bones' dual quaternions
    const ocl::Buffer<float>& displacement;
    const ocl::Buffer<float>& share;         // TextureMatcher::match
    const ocl::Buffer<int32_t>* candidates;  // SurfaceVisibility::find_contour; nullptr: all
    ocl::Buffer<float>& skinned;
    ocl::Buffer<float>& normals;
    const ocl::Buffer<float>& moved;  // nothing is done where it holds less than
    float least_moved_px;
    const ocl::Buffer<int32_t>& state;  // see ocl/groups_together.h, 0 before
  };
  // Enqueued, nothing blocks.
  void look(const Look& look);
  // [w*h] depth and triangle of each pixel, see raster/depth_and_id.h.
  const ocl::Buffer<uint64_t>& drawn() const { return drawn_; }

 private:
  Skinner& skinner_;
  DepthRasterizer& rasterizer_;
  SurfaceVisibility& visibility_;
  TextureMatcher& matcher_;
  SkinShading& shading_;
  PinholeArg pinhole_;
  ocl::Buffer<uint64_t> drawn_;
  size_t n_groups_ = 1;
  bool usable_ = false;
  ocl::Kernel kernel_;
};

}  // namespace livecap
