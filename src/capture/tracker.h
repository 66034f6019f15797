// One frame of the method: stage I (pose), stage II (surface), and whether the person is still the one that was
// followed. Stage I runs on one thread, stage II on it or on another.
#pragma once

#include <optional>
#include <vector>

#include "actor/actor.h"
#include "capture/pose_stage.h"
#include "capture/surface_stage.h"
#include "capture/tracker_options.h"
#include "image/device_frame.h"
#include "livecap/camera.h"
#include "livecap/capture.h"
#include "pose/floor.h"
#include "raster/depth.h"
#include "raster/visibility.h"

namespace livecap {

struct TrackInput {
  const ImageRgb& image;  // undistorted
  const Detections& detections;
  const Silhouette& silhouette;  // without a person in the detections: of whatever is not the background
  const ImageGray& mask;         // the silhouette as pixels, for the IoU
  // Picture, silhouette and mask on the solver's device; nullptr: they are uploaded from the above. With it only the
  // silhouette's area is looked at.
  const DeviceFrame* frame = nullptr;
  double time_s = 0;    // of the frame, rising
  bool nobody = false;  // whatever the network saw
};

struct TrackResult {
  TrackStatus status = TrackStatus::kNobody;
  Pose pose;                                       // valid when tracked
  Light light{1};                                  // that it was solved in, for stage II
  Eigen::Vector3d up = -Eigen::Vector3d::UnitY();  // PoseStage::up(), likewise
  std::vector<float> vertices_mm;                  // [3*n_vertices] camera frame; empty unless tracked
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
  // Throws ConfigError for options out of range.
  Tracker(ocl::DeviceContext& device, const Actor& actor, const Camera& camera, const TrackerOptions& options)
      : Tracker(device, device, actor, camera, options) {}
  // surface_device: for stage II. With a queue of its own to the same memory (SharedMemory) solve_surface may run
  // beside solve_pose of later frames.
  Tracker(ocl::DeviceContext& device, ocl::DeviceContext& surface_device, const Actor& actor, const Camera& camera,
          const TrackerOptions& options);

  // Stage I of the next frame: status, pose, and what concerns them. Throws LogicError when there is a person or a
  // silhouette and the mask is not of the camera's size.
  TrackResult solve_pose(const TrackInput& given);
  // Stage II of a frame whose pose was solved, in the same order; poses of later frames may have been solved meanwhile
  // if it has a frame on the device. Fills in the rest of the result: nothing for a frame that was not tracked.
  void solve_surface(const TrackInput& given, TrackResult& result);
  // One after the other.
  TrackResult track(const TrackInput& given);

  // Which way is up by what the camera sees of the room. Stays so. Not beside solve_pose().
  void set_upright(const Upright& upright) { pose_stage_.set_upright(upright); }
  // What the person stands on as of the last pose: PoseStage::floor(). Not beside solve_pose().
  const Floor* floor() const { return pose_stage_.floor(); }

  // The next frame with detections is initialised. What was learned of light, floor and legs stays.
  void lose_person();
  // Forgets that too.
  void reset();

 private:
  struct Solved {
    PoseResult pose;
    bool accepted = false;
    bool initialized = false;
  };
  Solved solve_seen(const PoseStageInput& input);
  Solved solve_missed(const PoseStageInput& input);
  bool covers(const PoseStageInput& input, const Pose& pose, double least_iou);  // the silhouette
  Pose predict() const;
  const DeviceFrame& frame_of(const TrackInput& given) const;

  const Actor& actor_;
  Camera camera_;
  TrackerOptions options_;
  DepthRasterizer rasterizer_;
  SurfaceVisibility visibility_;
  PoseStage pose_stage_;
  DeviceFrame frame_;  // where what comes from the host is uploaded to
  // Of stage II.
  DepthRasterizer surface_rasterizer_;
  SurfaceVisibility surface_visibility_;
  SurfaceStage surface_stage_;

  int doubtful_frames_ = 0;  // on end until the last frame
  int missed_frames_ = 0;    // on end until the last frame, those in which the silhouette was followed included
  std::optional<Pose> last_pose_;
  std::optional<Pose> pose_before_last_;
};

}  // namespace livecap
