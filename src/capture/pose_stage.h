// Stage I of one frame: from the predicted pose, and from what is tried beside it where that may have led to the wrong
// place. The better solution counts, and what is learned of it.
#pragma once

#include <span>
#include <vector>

#include "actor/actor.h"
#include "capture/pose_rounds.h"
#include "capture/tracker_options.h"
#include "livecap/camera.h"
#include "match/skin_light.h"
#include "pose/floor.h"
#include "pose/leg_bias.h"
#include "pose/leg_exchange.h"
#include "pose/pose_solver.h"
#include "raster/depth.h"
#include "raster/visibility.h"

namespace livecap {

class PoseStage {
 public:
  // Everything given but the options must outlive it. rasterizer and visibility are left as the last solve used them.
  // Throws ConfigError for options out of range.
  PoseStage(ocl::DeviceContext& device, const Actor& actor, const Camera& camera, const TrackerOptions& options,
            DepthRasterizer& rasterizer, SurfaceVisibility& visibility);

  // Before the first solve of a frame.
  void set_picture(const PoseStageInput& input) { rounds_.set_picture(input); }

  // The frame after one whose pose was `previous`.
  PoseResult solve_tracked(const PoseStageInput& input, const Pose& predicted, const Pose& previous);

  // From the detections alone. kNoObservations when they do not tell a pose.
  PoseResult find(const PoseStageInput& input);

  // Skins the template and renders it.
  void render(const Pose& pose) { rounds_.render(pose); }
  // The last pose solved, of this input, is believed: its colours tell of the light, its feet of the floor, its legs of
  // what the network sees of them. previous: that of the frame before, nullptr after another one.
  void learn(const PoseStageInput& input, const Pose* previous, const Pose& pose);

  // Whether the keypoints of a pose that was solved are near enough to the detections.
  bool believable(const PoseResult& result, const Detections& detections) const;

  // How brightly the actor is lit as it is drawn to be matched, learned so far.
  const Light& light() const { return rounds_.light(); }

  // Of the room, by its edges; where none tell, a body is taken to stand upright.
  void set_upright(const Upright& upright) { floor_.set_upright(upright); }
  // Which way things do not fall, camera frame, unit.
  Eigen::Vector3d up() const { return floor_.up(); }
  // nullptr while it is not known, or when a given one is contradicted.
  const Floor* floor() const { return floor_.is_contradicted() ? nullptr : floor_.floor(); }

  // Whether all rounds of a tracked frame are launched at once.
  bool looks_ahead(const PoseStageInput& input) const { return rounds_.looks_ahead(input); }

  // Of a frame that is not solved, with nobody in it and no silhouette.
  void miss_frame() {
    doubted_ = false;
    on_edge_frames_ = 0;
    twisted_frames_ = 0;
  }

  // Forgets what it knew of the last frames, but for light, floor and legs.
  void lose_person() {
    miss_frame();
    exchanged_frames_ = 0;
  }
  // Those too.
  void reset();

 private:
  using Rounds = PoseRounds::Rounds;
  using Solution = PoseRounds::Solution;

  PoseResult solve_corrected(const PoseStageInput& input, const Pose& predicted, const Pose& previous);
  Solution solve_anew(const PoseStageInput& input, std::span<const double> leans_rad);
  void make_comparable(const PoseStageInput& input, const Pose& previous, Solution& best);
  void finish(const PoseStageInput& input, const Pose& previous, Solution& best);
  void try_anew(const PoseStageInput& input, const Pose& previous, Solution& best);
  void try_exchanged_legs(const PoseStageInput& input, const Pose& predicted, const Pose& previous,
                          const std::vector<KeypointDetections>& alternatives, Solution& best);
  void try_turned(const PoseStageInput& input, const Pose& previous, Solution& best);
  void try_untwisted(const PoseStageInput& input, const Pose& previous, Solution& best);
  void try_other_legs(const PoseStageInput& input, const Pose& previous, Solution& best);
  void try_detected_legs(const PoseStageInput& input, const Pose& previous, Solution& best);
  void try_detected_arms(const PoseStageInput& input, const Pose& previous, Solution& best);
  bool covers_more(const PoseStageInput& input, const Solution& other, const Solution& best);
  void try_mirrored_forearms(const PoseStageInput& input, const Pose& previous, Solution& best);
  void try_refined(const PoseStageInput& input, const Pose& initial, const Pose& previous, Solution& best);
  void try_from(const PoseStageInput& input, const Pose& initial, const Pose& previous, Solution& best);
  std::optional<Pose> with_free_legs(const PoseStageInput& input, const Pose& previous, const Pose& pose);
  static void keep_better(Solution other, Solution& best);

  const Actor& actor_;
  Camera camera_;
  TrackerOptions options_;  // for this actor
  DepthRasterizer& rasterizer_;
  FloorFinder floor_;
  LegBias leg_bias_;
  PoseRounds rounds_;
  std::vector<SkinSample> last_skin_;  // of the pose solved last
  int last_drawn_ = 0;                 // likewise, PoseRounds::Solution
  int exchanged_frames_ = 0;           // since the detections last agreed with the prediction, or were tried as named
  int on_edge_frames_ = 0;             // since a foot stands on its edge, or other legs were tried
  int twisted_frames_ = 0;             // since the spine is twisted
  bool doubted_ = false;               // the last frame's pose was not believable
};

}  // namespace livecap
