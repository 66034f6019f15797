// Stage I of one frame: the contour and the matches of the actor as it is thought to be, and pose solves in between;
// and what is tried beside the predicted pose where that may have led to the wrong place.
#pragma once

#include <optional>
#include <vector>

#include "actor/actor.h"
#include "actor/skinner.h"
#include "capture/tracker_options.h"
#include "image/device_frame.h"
#include "image/silhouette.h"
#include "livecap/camera.h"
#include "match/actor_sight.h"
#include "match/skin_shading.h"
#include "match/texture_matcher.h"
#include "pose/floor.h"
#include "pose/leg_bias.h"
#include "pose/leg_exchange.h"
#include "pose/pose_solver.h"
#include "raster/depth.h"
#include "raster/visibility.h"

namespace livecap {

struct PoseStageInput {
  const Detections& detections;
  const Silhouette& silhouette;
  const DeviceFrame& frame;  // of the picture; not looked at while the silhouette is empty
  bool detected = true;      // false: nobody was, the detections are where the motion leads
};

class PoseStage {
 public:
  // Everything given but the options must outlive it. rasterizer and visibility are left as the last solve used them.
  // Throws ConfigError for options out of range.
  PoseStage(ocl::DeviceContext& device, const Actor& actor, const Camera& camera, const TrackerOptions& options,
            DepthRasterizer& rasterizer, SurfaceVisibility& visibility);

  // Before the first solve of a frame.
  void set_picture(const PoseStageInput& input);

  // The frame after one whose pose was `previous`.
  PoseResult solve_tracked(const PoseStageInput& input, const Pose& predicted, const Pose& previous);

  // From the detections alone. kNoObservations when they do not tell a pose.
  PoseResult find(const PoseStageInput& input);

  // Skins the template and renders it.
  void render(const Pose& pose);
  // The last pose solved is believed: its skin tells of the light, its feet of the floor, its legs of what the network
  // sees of them. previous: that of the frame before, nullptr after another one.
  void learn(const Pose* previous, const Pose& pose, const Detections& detections);

  // Whether the keypoints of a pose that was solved are near enough to the detections.
  bool believable(const PoseResult& result, const Detections& detections) const;

  // Whether all rounds of a tracked frame are launched at once.
  bool looks_ahead(const PoseStageInput& input) const;

  // Of a frame that is not solved, with nobody in it and no silhouette.
  void miss_frame() { doubted_ = false; }

  // Forgets what it knew of the last frames, but for light, floor and legs.
  void lose_person() {
    exchanged_frames_ = 0;
    doubted_ = false;
  }
  // Those too.
  void reset();

 private:
  struct Solution {
    PoseResult pose;
    // The energy, and for what the last round did not match that of a match missed_px away: alone it would favour who
    // matches less.
    double cost = 0;
    std::vector<SkinSample> skin;  // as the last round found it
    bool exchanged = false;        // from detections with the legs exchanged
    bool is_comparable = true;     // false: feet counted foot_share times in its cost
  };
  enum class Rounds {
    kAll,       // of match_levels
    kOnFeet,    // the same, in the refining ones feet count foot_share times
    kRefining,  // those of kAll
    kFinishing  // the last one of kOnFeet
  };
  int first_of(Rounds rounds, const PoseStageInput& input) const;  // of match_levels
  static bool counts_feet(Rounds rounds) { return rounds == Rounds::kOnFeet || rounds == Rounds::kFinishing; }
  const ocl::Buffer<float>& share_in(Rounds rounds, bool refining) const;
  Solution solve_in_rounds(const PoseStageInput& input, const Detections& detections, const Pose& initial,
                           const Pose* previous, Rounds rounds = Rounds::kAll);
  PoseResult solve_corrected(const PoseStageInput& input, const Pose& predicted, const Pose& previous);
  Solution solve_anew(const PoseStageInput& input);
  std::optional<Solution> solve_ahead(const PoseStageInput& input, const Detections& detections, const Pose& initial,
                                      const Pose* previous, Rounds rounds);
  PoseInput round_input(const PoseStageInput& input, const Detections& detections, const Pose& initial,
                        const Pose* previous, int level, Rounds rounds, bool refining) const;
  static double cost_with_doubt(const Solution& solution);
  double cost_of(const PoseResult& pose) const;
  void find_picture(const PoseStageInput& input);
  PoseResult solve_seen(PoseInput& solve, bool matches, bool shades, std::vector<SkinSample>& skin);
  PoseResult solve_read(PoseInput& solve, bool matches, bool shades, std::vector<SkinSample>& skin);
  void find_contour(const PoseStageInput& input, const Pose& pose);
  std::vector<int32_t> read_contour(const PoseStageInput& input);
  bool matches(const PoseStageInput& input) const;
  bool counts_feet(const PoseStageInput& input) const;
  bool shading(const PoseStageInput& input) const;
  void find_contour_and_visible(const Pose& pose, bool refining);
  void find_matches(const PoseStageInput& input, int level, const ocl::Buffer<float>& share);
  void make_comparable(const PoseStageInput& input, const Pose& previous, Solution& best);
  void finish(const PoseStageInput& input, const Pose& previous, Solution& best);
  void try_anew(const PoseStageInput& input, Solution& best);
  void try_exchanged_legs(const PoseStageInput& input, const Pose& predicted, const Pose& previous,
                          const std::vector<KeypointDetections>& alternatives, Solution& best);
  void try_turned(const PoseStageInput& input, const Pose& previous, Solution& best);
  void try_detected_legs(const PoseStageInput& input, const Pose& previous, Solution& best);
  bool covers_more(const PoseStageInput& input, const Solution& other, const Solution& best);
  void try_mirrored_forearms(const PoseStageInput& input, const Pose& previous, Solution& best);
  void try_refined(const PoseStageInput& input, const Pose& initial, const Pose& previous, Solution& best);
  static void keep_better(Solution other, Solution& best);
  void try_from(const PoseStageInput& input, const Pose& initial, const Pose& previous, Solution& best);

  ocl::DeviceContext& device_;
  const Actor& actor_;
  Camera camera_;
  TrackerOptions options_;
  SkinWeights skin_;  // hanging cloth's are not the actor's
  Skinner skinner_;
  DepthRasterizer& rasterizer_;
  SurfaceVisibility& visibility_;
  TextureMatcher matcher_;
  SkinShading shading_;
  ActorSight sight_;
  bool picture_due_ = false;  // the matcher does not have the frame's picture yet
  FloorFinder floor_;
  LegBias leg_bias_;
  PoseSolver solver_;
  ocl::Buffer<float> zero_;                   // [3n] always zero
  ocl::Buffer<float> skinned_;                // [3n]
  ocl::Buffer<float> normals_;                // [3n]
  ocl::Buffer<float> matched_share_;          // [n] 1 for vertices that are matched
  ocl::Buffer<float> refined_share_;          // [n] the same in the last rounds: less for hanging cloth
  ocl::Buffer<float> on_feet_share_;          // [n] and where no starts compete: more for feet
  ocl::Buffer<int32_t> refining_candidates_;  // the same for contour vertices of the last rounds
  std::vector<SkinSample> last_skin_;
  int exchanged_frames_ = 0;  // since the detections last agreed with the prediction, or were tried as named
  bool doubted_ = false;      // the last frame's pose was not believable
};

}  // namespace livecap
