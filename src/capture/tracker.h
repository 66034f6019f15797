// One frame of the method: stage I (pose), stage II (surface), snapping, and what is carried to the next frame.
// Runs on one thread with the solver context.
#pragma once

#include <optional>
#include <vector>

#include "actor/actor.h"
#include "actor/skinner.h"
#include "image/device_frame.h"
#include "livecap/camera.h"
#include "livecap/capture.h"
#include "match/texture_matcher.h"
#include "pose/pose_solver.h"
#include "raster/depth.h"
#include "raster/part_mask.h"
#include "raster/visibility.h"
#include "surface/hanging_cloth.h"
#include "surface/snap.h"
#include "surface/surface_solver.h"

namespace livecap {

struct TrackerOptions {
  PoseOptions pose;
  SurfaceOptions surface;
  SnapOptions snap;
  MatchOptions match;
  VisibilityOptions visibility;
  // Stage I of an actor with a texture: one solve per round, each with matches found at this resolution (half of it per
  // level) where the last one ended. Coarse ones first: patches are only right within a few px, and stripes match one
  // stripe further as well.
  std::vector<int> match_levels = {2, 2, 1, 0, 0};
  float min_matched_rigidity = 1.5f;  // softer cloth hangs where skinning does not know
  bool solve_pose = true;             // false: stage I ends with its initialisation from each frame's detections alone
  bool enable_surface = true;         // false: the result is the skinned template of stage I
  bool warp_displacements = true;     // carry the non-rigid displacement to the next frame
  // Only cloth keeps its displacement: what skin, hair and shoes seem to be displaced by is an error of the pose, and
  // carried on it would hold the pose there. A tenth is forgotten per frame (the paper: nothing); that helped one of
  // three sequences with ground truth and left the others as they were.
  float max_carried_rigidity = 3;
  float carried_share = 0.9f;
  // Stage II skins hanging cloth differently from stage I. On a simulated skirt with true keypoints its mean error was
  // 72 mm with the actor's weights, 54 mm so before anything is fitted; skirts whose weights follow the legs little
  // change little.
  HangingClothOptions hanging;
  bool part_mask = true;  // b_i = 0 on another body part's region
  bool snapping = true;
  bool ignore_confidence = false;  // true: every keypoint the network knows counts fully
  // Where the network seems to have exchanged the legs (pose/leg_exchange.h), stage I is solved both ways and the lower
  // energy counts; but for no more than this many frames until both agree again, since in the long run the network is
  // right. 0 = never.
  int max_exchanged_frames = 9;
  // A pose whose mean keypoint error exceeds this fraction of the person's height in the picture is not believed: the
  // frame is solved again from the detections alone, and lost when that does not help.
  double lost_error_fraction = 0.08;
  // ... unless it was believed until a moment ago: networks have single frames in which they see somebody else's limbs,
  // and stage I does not follow these (PoseOptions::keypoint_2d_huber_px). For so many frames on end its pose is kept.
  int max_doubtful_frames = 3;
  // After a frame in which the network saw nobody, the person is taken up again where the motion would have led for so
  // many frames on end. What is not believed then is nobody: networks go on seeing something where a person just was.
  // In between the silhouette alone is followed, as long as the mesh has this IoU with it.
  int max_missed_frames = 5;
  double least_missed_iou = 0.75;
};

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
  Solved solve_pose(const TrackInput& input);
  Solved solve_missed(const TrackInput& input);
  Pose predict() const;
  PoseResult solve_tracked(const TrackInput& input, const Pose& predicted);
  std::vector<int32_t> find_contour(const TrackInput& input, const Pose& pose);
  bool matches(const TrackInput& input) const;
  std::vector<VertexMatch> find_matches(int level);
  PoseResult solve_in_rounds(const TrackInput& input, const Detections& detections, const Pose& initial,
                             const Pose* previous);
  PoseResult solve_anew(const TrackInput& input, const Pose& initial);
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
  TextureMatcher matcher_;
  PoseSolver pose_solver_;
  SurfaceSolver surface_solver_;
  Snapper snapper_;
  DeviceFrame frame_;  // where what comes from the host is uploaded to
  const DeviceFrame* picture_ = &frame_;

  ocl::Buffer<float> displacement_rest_;         // d-hat, rest frame; zero before the first surface
  ocl::Buffer<float> before_displacement_rest_;  // the same of the frame before
  ocl::Buffer<float> zero_;                      // [3n] always zero
  ocl::Buffer<float> matched_share_;             // [n] 1 for vertices that stage I matches
  ocl::Buffer<float> carried_share_;             // [n] share of each vertex's displacement that is carried on
  ocl::Buffer<float> start_;                     // V^S + d^S
  ocl::Buffer<float> skinned_;                   // V^S
  ocl::Buffer<float> normals_;
  ocl::Buffer<float> vertices_;  // the result
  ocl::Buffer<float> before_;    // V^S + d^S of the frame before the last
  int n_history_ = 0;            // of how many frames (at most two) there is a displacement

  int doubtful_frames_ = 0;   // on end until the last frame
  int missed_frames_ = 0;     // on end until the last frame, those in which the silhouette was followed included
  int exchanged_frames_ = 0;  // since the detections last agreed with the prediction
  std::optional<Pose> last_pose_;
  std::optional<Pose> pose_before_last_;
};

}  // namespace livecap
