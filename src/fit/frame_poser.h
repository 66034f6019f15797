// One actor's pose in single frames of a video, each on its own, and what of it the camera sees: what `actor fit`
// compares with the pictures.
#pragma once

#include <cstdint>
#include <vector>

#include "actor/actor.h"
#include "actor/skinner.h"
#include "base/detections.h"
#include "image/device_frame.h"
#include "image/silhouette.h"
#include "livecap/camera.h"
#include "pose/pose_solver.h"
#include "raster/depth.h"
#include "raster/visibility.h"
#include "texture/surface_views.h"

namespace livecap {

// A frame in which the whole person is seen.
struct FitFrame {
  int64_t index = 0;  // of the video
  ImageRgb image;     // undistorted
  ImageGray mask;     // 255 = person
  Silhouette silhouette;
  Detections detections;
  Pose pose;  // of the actor that is compared with it; valid when posed
  bool posed = false;
};

class FramePoser {
 public:
  // camera: undistorted. The actor must outlive it; its keypoints are the network's (keypoint_offsets.h).
  FramePoser(ocl::DeviceContext& device, const Actor& actor, const Camera& camera);

  // The pose from this frame's detections and silhouette alone; frame.posed tells whether it can be believed.
  void solve(FitFrame& frame);

  // The skinned actor's overlap with the mask (intersection over union) in frame.pose.
  double overlap(const FitFrame& frame);

  // Vertices on the outline of the actor with other bone lengths (skeleton) and another rest surface (moved by
  // displacement_mm, [3*n_vertices]).
  std::vector<int32_t> outline(const Skeleton& skeleton, const Pose& pose, const std::vector<float>& displacement_mm);

  // Which vertices are seen in frame.pose, how straight, and where.
  ViewCoverage cover(const FitFrame& frame);

 private:
  void render(const Skeleton& skeleton, const Pose& pose);

  const Actor& actor_;
  Camera camera_;
  // The outline counts less than in a capture: while the proportions are wrong, limbs would bend to fill it.
  PoseOptions options_{.weights = {.silhouette = 400}, .keypoint_2d_huber_px = 8, .silhouette_huber_px = 3};
  PoseSolver solver_;
  Skinner skinner_;
  DepthRasterizer rasterizer_;
  SurfaceVisibility visibility_;
  DeviceFrame frame_;
  ocl::Buffer<uint8_t> mask_;  // of overlap()
  ocl::Buffer<float> displacement_, posed_, normals_;
};

}  // namespace livecap
