// One frame of the method: stage I (pose), stage II (surface), snapping, and what is carried to the next frame.
// Runs on one thread with the solver context.
#pragma once

#include <optional>
#include <vector>

#include "actor/actor.h"
#include "actor/skinner.h"
#include "capture/pose_stage.h"
#include "capture/tracker_options.h"
#include "image/device_frame.h"
#include "livecap/camera.h"
#include "livecap/capture.h"
#include "raster/depth.h"
#include "raster/part_mask.h"
#include "raster/visibility.h"
#include "surface/hanging_cloth.h"
#include "surface/snap.h"
#include "surface/surface_solver.h"

namespace livecap {

struct TrackInput {
  const ImageRgb& image;  // undistorted
  const Detections& detections;
  const Silhouette& silhouette;  // without a person in the detections: of whatever is not the background
  const ImageGray& mask;         // the silhouette as pixels, for the IoU
  // Picture, silhouette and mask on the solver's device; nullptr: they are uploaded from the above. With it only the
  // silhouette's area is looked at.
  const DeviceFrame* frame = nullptr;
};

struct TrackResult {
  TrackStatus status = TrackStatus::kNobody;
  Pose pose;                       // valid when tracked
  std::vector<float> vertices_mm;  // [3*n_vertices] camera frame; empty unless tracked
  double pose_energy = 0;
  double surface_energy = 0;
  double keypoint_error_px = 0;
  double iou = 0;  // rendered mesh against the mask
  double pose_ms = 0;
  double surface_ms = 0;
};

class Tracker {
 public:
  // camera: undistorted. Builds every program and allocates every buffer. The actor must outlive the tracker.
  Tracker(ocl::DeviceContext& device, const Actor& actor, const Camera& camera, const TrackerOptions& options);

  // Throws LogicError when there is a person or a silhouette and the mask is not of the camera's size.
  TrackResult track(const TrackInput& given);

  // Forgets the person: the next frame with detections is initialised.
  void reset();

 private:
  struct Solved {
    PoseResult pose;
    bool accepted = false;
    bool initialized = false;
  };
  Solved solve_pose(const PoseStageInput& input);
  Solved solve_missed(const PoseStageInput& input);
  Pose predict() const;
  bool believable(const PoseResult& result, const Detections& detections) const;
  void solve_surface(const Pose& pose, bool has_picture, TrackResult& result);

  const Actor& actor_;
  Camera camera_;
  TrackerOptions options_;
  int n_vertices_;

  Skinner skinner_;  // stage I
  HangingCloth hanging_;
  Skinner surface_skinner_;  // stage II
  DepthRasterizer rasterizer_;
  SurfaceVisibility visibility_;
  PartMask part_mask_;
  PoseStage pose_stage_;
  SurfaceSolver surface_solver_;
  Snapper snapper_;
  DeviceFrame frame_;  // where what comes from the host is uploaded to
  const DeviceFrame* picture_ = &frame_;

  ocl::Buffer<float> displacement_rest_;         // d-hat, rest frame; zero before the first surface
  ocl::Buffer<float> before_displacement_rest_;  // the same of the frame before
  ocl::Buffer<float> zero_;                      // [3n] always zero
  ocl::Buffer<float> carried_share_;             // [n] share of each vertex's displacement that is carried on
  ocl::Buffer<float> start_;                     // V^S + d^S
  ocl::Buffer<float> skinned_;                   // V^S
  ocl::Buffer<float> normals_;
  ocl::Buffer<float> vertices_;  // the result
  ocl::Buffer<float> before_;    // V^S + d^S of the frame before the last
  int n_history_ = 0;            // of how many frames (at most two) there is a displacement

  int doubtful_frames_ = 0;  // on end until the last frame
  int missed_frames_ = 0;    // on end until the last frame, those in which the silhouette was followed included
  std::optional<Pose> last_pose_;
  std::optional<Pose> pose_before_last_;
};

}  // namespace livecap
