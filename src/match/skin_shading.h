// Bare skin has no texture that could be matched, but it has shading: how bright a limb is tells how far it is turned
// towards the light, and so towards or from the camera, which its outline does not. With true normals the tilt of
// forearms and shins that explains a path-traced picture best is within 5 to 10 degrees of the truth in half of the
// frames (docs/experiments.md).
//
//   SkinShading shading(device, actor, camera, options);
//   shading.measure(frame, raster, positions, normals, visible);  // `raster` has rendered `positions`
//   std::vector<SkinSample> samples = shading.read();
//   solver.solve({..., .shaded = shading.shaded(samples)});       // E_shading, kernels/terms/shading.cl
//   shading.learn(samples);                                       // of a pose that is believed
#pragma once

#include <array>
#include <span>
#include <vector>

#include "actor/actor.h"
#include "geometry/seen_vertices.h"
#include "geometry/shaded_vertex.h"
#include "image/device_frame.h"
#include "match/skin_light.h"
#include "ocl/buffer.h"
#include "ocl/kernel.h"
#include "raster/depth.h"

namespace livecap {

struct SkinShadingOptions {
  SkinLightOptions light;
  float min_facing = 0.45f;   // cosine of normal and view; beyond it the limb's edge begins
  float depth_range_mm = 25;  // pixels further from their vertex are of another limb
  float limb_area_px = 400;   // a limb that shows so many px or more has weight 1, others less

  void validate() const;  // throws ConfigError
};

class SkinShading {
 public:
  // Keeps no reference to the actor. camera: undistorted. Of use are the vertices with the labels of arms and legs on
  // upper arms, forearms, thighs and shanks. Throws ConfigError.
  SkinShading(ocl::DeviceContext& device, const Actor& actor, const Camera& camera, const SkinShadingOptions& options);

  // False for an actor without bare arms or legs: then nothing is ever seen.
  bool usable() const { return !skin_.empty(); }

  // raster: rendered the positions. positions, normals [3*n_vertices] mm and unit, camera frame; visible [n_vertices].
  // Enqueued, nothing blocks.
  void measure(const DeviceFrame& frame, const DepthRasterizer& raster, const ocl::Buffer<float>& positions,
               const ocl::Buffer<float>& normals, const ocl::Buffer<int32_t>& visible);

  // Of skin in either light, red and blue, and how far from these something else begins: as kernels take them.
  struct Tints {
    struct {
      float of[4];
    } red_blue;
    struct {
      float of[2];
    } off;
  };
  Tints tints() const;

  // What was measured last. Blocking.
  std::vector<SkinSample> read();
  // In two parts: samples() once a blocking read through the same queue has come after read_later().
  void read_later();
  std::vector<SkinSample> samples() const;

  // What stage I fits to; nothing while the light is not known.
  std::vector<ShadedVertex> shaded(std::span<const SkinSample> samples) const;

  // The same for a device that chooses by itself from what was measured.
  SeenSkin seen() const;

  // Mean squared residual (in deviations; linear beyond huber of them) of the samples on a bone if that were turned;
  // turn: camera frame. 0 when next to nothing of it is seen or the light is not known.
  double misfit(std::span<const SkinSample> samples, int bone, const Eigen::Matrix3d& turn, double huber) const;

  void learn(std::span<const SkinSample> samples);
  void forget();

 private:
  friend class ActorSight;  // does the same in one launch with more
  struct SkinVertex {
    int32_t vertex;
    int bone;   // its strongest
    int limb;   // the same among those with skin
    int light;  // index of lights_
  };

  SkinShadingOptions options_;
  int width_, height_;
  float focal_px_;
  bool is_cpu_;
  std::vector<SkinVertex> skin_;
  std::array<SkinLight, 2> lights_;  // on arms; on legs, which stand in the shadow of clothes
  std::vector<float> host_;

  ocl::Buffer<int32_t> vertices_;  // [skin_.size()]
  ocl::Buffer<int32_t> limbs_;     // likewise, see SeenSkin
  ocl::Buffer<float> albedo_;      // [3*skin_.size()] linear
  ocl::Buffer<float> areas_;       // [skin_.size()] mm^2
  ocl::Buffer<uint8_t> is_skin_;   // [n_vertices]
  ocl::Buffer<float> samples_;     // [LC_SKIN*skin_.size()], see match/layout.h
  ocl::Kernel kernel_;
};

}  // namespace livecap
