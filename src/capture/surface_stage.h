// Stage II of one frame: how cloth swings, the warped displacement, the non-rigid solve, snapping, and what is carried
// to the next frame.
#pragma once

#include <optional>

#include "actor/actor.h"
#include "actor/skinner.h"
#include "capture/tracker_options.h"
#include "cloth/cloth_simulation.h"
#include "cloth/drape.h"
#include "cloth/hanging_cloth.h"
#include "image/device_frame.h"
#include "image/person_gate.h"
#include "livecap/camera.h"
#include "match/cloth_anew.h"
#include "match/cloth_behind.h"
#include "match/texture_matcher.h"
#include "raster/depth.h"
#include "raster/part_mask.h"
#include "raster/visibility.h"
#include "surface/snap.h"
#include "surface/surface_solver.h"

namespace livecap {

class SurfaceStage {
 public:
  // Everything given but the options must outlive it. rasterizer and visibility are left as the last solve used them.
  // Throws ConfigError for options out of range.
  SurfaceStage(ocl::DeviceContext& device, const Actor& actor, const Camera& camera, const TrackerOptions& options,
               DepthRasterizer& rasterizer, SurfaceVisibility& visibility);

  // picture: nullptr where nothing is segmented: the template then, skinned and its cloth simulated. person: the box
  // around the silhouette. time_s: of the frame, for how cloth swings. light: how brightly the actor is lit
  // (TextureMatcher::set_light). up: unit, camera frame; cloth falls the other way. Returns the energy.
  double solve(const Pose& pose, double time_s, const DeviceFrame* picture, const PixelBox& person, const Light& light,
               const Eigen::Vector3d& up);

  // The skinned template instead of a solve.
  void skin_template(const Pose& pose);

  // [3*n_vertices] mm, camera frame, of the last solve or template.
  const ocl::Buffer<float>& vertices() const { return vertices_; }

  // Forgets the displacement and how cloth moves.
  void reset();

 private:
  void place(const PosedSkeleton& posed, double seconds, const Eigen::Vector3d& up);
  void launch(const DeviceFrame& picture, const PixelBox& person);
  void snap(const SurfaceInput& solved);
  SurfaceInput seen_from(const ocl::Buffer<float>& vertices, const DeviceFrame& picture);

  ocl::DeviceContext& device_;
  const Actor& actor_;
  Camera camera_;
  TrackerOptions options_;
  const float looseness_;  // of what hangs
  HangingCloth hanging_;
  std::optional<ClothSimulation> cloth_;  // where it is simulated
  std::optional<Drape> drape_;            // where that is matched
  double last_time_s_ = 0;
  Skinner skinner_;           // of the template with hanging cloth
  Skinner template_skinner_;  // of the template as it is
  DepthRasterizer& rasterizer_;
  SurfaceVisibility& visibility_;
  PartMask part_mask_;
  SurfaceSolver solver_;
  Snapper snapper_;
  std::optional<TextureMatcher> cloth_matcher_;  // where something hangs that has a texture
  std::optional<ClothBehind> cloth_behind_;      // likewise, with a share of more than 0
  std::optional<ClothAnew> cloth_anew_;          // likewise, where displacements are carried on

  ocl::Buffer<float> displacement_rest_;         // d-hat, rest frame; zero before the first surface
  ocl::Buffer<float> before_displacement_rest_;  // the same of the frame before
  ocl::Buffer<float> zero_;                      // [3n] always zero
  ocl::Buffer<float> carried_share_;             // [n] share of each vertex's displacement that is carried on
  ocl::Buffer<float> hangs_;                     // [n] 1 of what hangs, else 0
  ocl::Buffer<float> start_;                     // V^S + d^S
  ocl::Buffer<float> skinned_;                   // V^S
  ocl::Buffer<float> normals_;
  ocl::Buffer<float> vertices_;  // the result
  ocl::Buffer<float> before_;    // V^S + d^S of the frame before the last
  int n_history_ = 0;            // of how many frames (at most two) there is a displacement
};

}  // namespace livecap
