// Stage I from one start: rounds of what is seen of the actor where it is thought to be (contour, matches, shaded skin)
// and a pose solve with that, at coarse resolutions first. Who starts where, and which solution counts, is PoseStage's.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "actor/actor.h"
#include "actor/skinner.h"
#include "capture/tracker_options.h"
#include "image/device_frame.h"
#include "image/silhouette.h"
#include "livecap/camera.h"
#include "match/actor_sight.h"
#include "match/harmonic_light.h"
#include "match/skin_shading.h"
#include "match/texture_matcher.h"
#include "pose/floor.h"
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

class PoseRounds {
 public:
  // Everything given but the options must outlive it. options: as options_for() has them for this actor. floor: what it
  // has found is in every solve. rasterizer and visibility are left as the last solve used them.
  PoseRounds(ocl::DeviceContext& device, const Actor& actor, const Camera& camera, const TrackerOptions& options,
             const FloorFinder& floor, DepthRasterizer& rasterizer, SurfaceVisibility& visibility);

  // Before the first solve of a frame.
  void set_picture(const PoseStageInput& input);

  struct Solution {
    PoseResult pose;
    // The energy, and what the last round did not match costs (missed_px): alone it would favour who matches less. Both
    // as if as much showed as when the frame was solved first (after the first round, where the host waits for each): a
    // limb that hides or is seen from its end would gain.
    double cost = 0;
    std::vector<SkinSample> skin;  // as the last round found it
    int drawn = 0;                 // number of its last drawing
    bool exchanged = false;        // from detections with the legs exchanged
    bool is_comparable = true;     // false: feet counted foot_share times in its cost
  };
  enum class Rounds {
    kAll,        // of match_levels
    kOnFeet,     // the same, in the refining ones feet count foot_share times
    kRefining,   // those of kAll
    kFinishing,  // the last one of kOnFeet
    kFreeLegs  // the refining ones of kOnFeet without E_floor and E_temporal, with free_legs_3d: what the picture tells
  };
  // detections: instead of the input's. previous: nullptr for a pose that follows none.
  Solution solve(const PoseStageInput& input, const Detections& detections, const Pose& initial, const Pose* previous,
                 Rounds rounds);
  // One solve from a rough pose that follows none, with its contour alone.
  PoseResult solve_rough(const PoseStageInput& input, const Pose& initial);

  // Skins the template and renders it.
  void render(const Pose& pose);

  // Whether there is something to match, whether feet may count more, and whether skin is shaded.
  bool matches(const PoseStageInput& input) const;
  bool counts_feet(const PoseStageInput& input) const;
  bool shading(const PoseStageInput& input) const;
  // Whether all rounds are launched before the first is over.
  bool looks_ahead(const PoseStageInput& input) const;

  SkinShading& skin_shading() { return shading_; }

  // Of a solution that is believed: how the actor is lit in the next frames. Nothing is learned where something else
  // has been drawn since.
  void learn_light(const PoseStageInput& input, int drawn);
  void forget_light();
  // How brightly the actor is lit; 1 everywhere while the light is not known.
  const Light& light() const { return matcher_.light(); }

 private:
  struct Round {
    int level = 0;  // of what is matched
    bool refining = false;
    bool on_feet = false;  // feet count foot_share times
    bool free_legs = false;
    bool shades = false;
    double least_moved_px = 0;  // left out where the round before moved no keypoint so far
  };
  std::vector<Round> plan_rounds(const PoseStageInput& input, Rounds rounds) const;
  std::optional<Solution> solve_ahead(const PoseStageInput& input, const Detections& detections, const Pose& initial,
                                      const Pose* previous, const std::vector<Round>& plan);
  PoseInput round_input(const PoseStageInput& input, const Detections& detections, const Pose& initial,
                        const Pose* previous, const Round& round) const;
  PoseResult solve_seen(PoseInput& solve, bool matches, bool shades, std::vector<SkinSample>& skin);
  PoseResult solve_read(PoseInput& solve, bool matches, bool shades, std::vector<SkinSample>& skin);
  double cost_of(const PoseResult& pose);
  const ocl::Buffer<float>& share_in(const Round& round) const;
  void find_picture(const PoseStageInput& input);
  void find_contour(const PoseStageInput& input, const Pose& pose);
  void find_contour_and_visible(const Pose& pose, bool refining);
  void find_matches(const PoseStageInput& input, const Round& round);

  ocl::DeviceContext& device_;
  const Actor& actor_;
  Camera camera_;
  TrackerOptions options_;
  const FloorFinder& floor_;
  SkinWeights skin_;  // hanging cloth's are not the actor's
  Skinner skinner_;
  DepthRasterizer& rasterizer_;
  SurfaceVisibility& visibility_;
  TextureMatcher matcher_;
  SkinShading shading_;
  int n_drawn_ = 0;
  HarmonicLight actor_light_;
  ActorSight sight_;
  bool picture_due_ = false;      // the matcher does not have the frame's picture yet
  double first_seen_weight_ = 0;  // PoseResult::seen_weight of the frame, found first; 0: none yet
  PoseSolver solver_;
  ocl::Buffer<float> zero_;                   // [3n] always zero
  ocl::Buffer<float> skinned_;                // [3n]
  ocl::Buffer<float> normals_;                // [3n]
  ocl::Buffer<float> matched_share_;          // [n] see capture/pose_shares.h, likewise the next two
  ocl::Buffer<float> refined_share_;          // [n]
  ocl::Buffer<float> on_feet_share_;          // [n]
  ocl::Buffer<int32_t> refining_candidates_;  // contour vertices of refining rounds are among them
};

}  // namespace livecap
