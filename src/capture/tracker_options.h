// Options of the tracker: both stages, and what holds them together.
#pragma once

#include <vector>

#include "cloth/cloth_simulation.h"
#include "cloth/drape.h"
#include "cloth/hanging_cloth.h"
#include "match/harmonic_light.h"
#include "match/skin_shading.h"
#include "match/texture_matcher.h"
#include "pose/floor.h"
#include "pose/leg_bias.h"
#include "pose/pose_options.h"
#include "raster/visibility.h"
#include "surface/snap.h"
#include "surface/surface_input.h"

namespace livecap {

// The segmentation goes on for as long.
inline constexpr int kMaxMissedFrames = 5;

// How much the match of each vertex counts in stage I.
struct PoseSharesOptions {
  // Cloth softer than this is matched only near where it is fastened, where its weights on the legs sum to less than
  // max_matched_leg_weight: further down it hangs where skinning does not know.
  float min_matched_rigidity = 1.5f;
  float max_matched_leg_weight = 0.3f;
  // What is matched of hanging cloth counts so much of its weight in refining rounds: it swings, and would turn hips
  // and legs.
  float refined_hanging_share = 0.3f;
  // What is matched of a foot counts so many times its weight in refining rounds: a foot ends its leg, whose depth
  // little else tells, and a shoe is matched to a part of a pixel, but it is small. Not where starts compete, since
  // legs that are exchanged hold on to the wrong shoes; what is chosen of them is refined once more. Not in the first
  // frame either.
  float foot_share = 40;
  // The same of an actor whose shape is rough: a shoe that is 5 mm too short is a foot 80 mm too near, at 4 m.
  float rough_foot_share = 8;

  void validate() const;  // throws ConfigError
};

// How stage I solves from one start.
struct PoseRoundsOptions {
  // Of an actor with a texture: one solve per round, each with matches found at this resolution (half of it per level)
  // where the last one ended. Coarse ones first: patches are only right within a few px, and stripes match one stripe
  // further as well. Each 0..LC_MATCH_LEVELS.
  std::vector<int> match_levels = {2, 2, 1, 0, 0};
  // So many of the last rounds are refining ones: what is not matched because it hangs is no contour in them either.
  // (Without a texture there are none.)
  int refining_rounds = 2;
  // A second round at one resolution is left out when the first moved no keypoint as far as this, px of that
  // resolution.
  double settled_round_px = 2;
  // A round ends after a step that moved no keypoint as far as this, px of the picture: matches are a picture's noise
  // away from the truth, and fitting them more closely only follows it.
  double settled_step_px = 1;
  double settled_last_step_px = 0.3;  // settled_step_px of rounds at full resolution, which decide
  // Where the texture is matched E_3D counts so much: the picture then tells depth better than the network does.
  double matched_3d = 0.3;
  // In refining rounds E_3D of arms counts so much of what it counts elsewhere: which way they point is the network's
  // to say, how far the lengths in the picture tell better.
  double refined_arms_3d = 0.1;
  // In refining rounds a detection counts half where it is so far from the body (pose/targets.h); 0: it is not doubted.
  double refined_doubt_3d_mm = 40;
  // Where feet count PoseSharesOptions::foot_share times, E_3D of legs counts so much of what it counts elsewhere: the
  // network sees bent ones straight, and the shoes tell better.
  double on_feet_legs_3d = 0.1;
  // The same where legs are free, to tell of the floor. 0: never free.
  double free_legs_3d = 0.03;
  // Where several starts compete, what could not be matched, and what a match falls short of a correlation of 1, costs
  // as one so far away would if it grew by the square for ever.
  double missed_px = 2;

  void validate() const;  // throws ConfigError
};

// Of a built actor, whose skinning weights are guessed: so many times each of these terms in stage I. What is matched
// near a joint pulls the wrong bones there; where keypoints lie, the body ends and how its skin is lit depend less on
// weights. In a skirt shading alone: its outline is not the body's, the network sees the bent legs below it straight,
// and it has guessed_power (HangingClothOptions). The blur is no factor, and of both stages.
struct GuessedWeightsOptions {
  double keypoint_2d = 2;
  double silhouette = 2;
  double shading = 2;
  float blur = 0.15f;  // instead of MatchOptions::blur: its texture was made of pictures, which lenses had blurred

  void validate() const;  // throws ConfigError
};

// Of who stands in a skirt or dress that hides the knees. A network guesses where they are: with all of its confidence,
// and up to 20 px off, for which a thigh swings to and fro.
struct HiddenKneesOptions {
  double least_cover_mm = 100;      // that the hem hangs below the knees, in the rest pose
  double keypoint_2d = 0.3;         // E_2D of knees counts so much of what it counts elsewhere
  double refined_doubt_3d_mm = 60;  // of all keypoints, unless none is doubted: little else tells of legs
  double least_stands = 0.1;        // of PoseOptions: a leg that is lifted towards the camera looks as one that is not
  double balance_share = 0.8;       // BalanceOptions::share: legs by the picture alone are 20 to 60 mm off, up or down

  void validate() const;  // throws ConfigError
};

// When stage I is solved from other starts than the predicted pose as well, and when those count.
struct OtherStartsOptions {
  // Who is seen for the first time, or again, is also looked for leaning towards the camera (negative: away from it) by
  // each of these, rad, from where the detections have them (pose/other_starts.h).
  std::vector<double> leans_rad = {-0.35, -0.175, 0.175, 0.35};
  // Who is found is found in balance: feet that are 100 mm farther or nearer than a standing body's
  // (pose/balance.h) cost this share more, of the whole cost, and by the square.
  double cost_of_imbalance = 0.1;
  // A body that faces so much elsewhere than the detections is solved from there as well (pose/other_starts.h).
  double least_turn_rad = 0.21;
  // A spine twisted by so much (pi: never) is also solved from the pelvis turned back under the chest
  // (pose/other_starts.h), in the first of such frames and then in every so many of them.
  double least_twist_rad = 0.12;
  int twisted_frames = 3;
  // The same of who is found anew: no frame before tells where the pelvis was.
  double least_found_twist_rad = 0.08;
  // A body of which a foot stands tilted by so much (pose/other_starts.h), in so many frames on end, is solved from
  // other legs as well, and again as often while that lasts.
  double on_edge_rad = 0.52;
  int on_edge_frames = 5;
  // A body with an ankle so far from its detection, as a share of the person's height in the picture, is solved from
  // legs bent to the detections as well (pose/other_starts.h). 0: never.
  double strayed_share = 0.04;
  // The same of an elbow or a wrist.
  double strayed_arm_share = 0.05;
  // And of an elbow that is nearer than the shoulder where the network has it farther, or the other way round, by so
  // much; where strayed_arm_share is 0 of none.
  double strayed_arm_depth_mm = 80;
  // Where limbs compete (legs exchanged or not, an arm as detected, an ankle that is strayed_share from its detection
  // by either name), a solution counts that costs more by this share times what more of the silhouette it covers (IoU);
  // one that covers less must cost less by as much.
  double cost_of_covering = 3.3;
  // A body is solved with a forearm mirrored in depth as well, if that turns it by so much and the skin's shading then
  // misfits less than this share of before (pose/mirrored_forearm.h, match/skin_shading.h).
  double least_mirrored_rad = 0.35;
  double mirrored_misfit = 0.9;
  // Where the network seems to have exchanged the legs (pose/leg_exchange.h), stage I is solved both ways and the
  // better one counts. After this many frames on end it is also solved from the detections alone, as named; that counts
  // where it is the better one, or where no texture tells. 0 = in every such frame.
  int max_exchanged_frames = 9;

  void validate() const;  // throws ConfigError
};

struct TrackerOptions {
  PoseOptions pose;
  PoseSharesOptions shares;
  PoseRoundsOptions rounds;
  GuessedWeightsOptions guessed;
  HiddenKneesOptions hidden_knees;
  OtherStartsOptions starts;
  MatchOptions match;
  SkinShadingOptions shading;
  HarmonicLightOptions actor_light{.least_frames = 2.9};  // the actor is drawn in it to be matched
  FloorOptions floor;
  LegBiasOptions leg_bias;
  VisibilityOptions visibility;
  SurfaceOptions surface;
  SnapOptions snap;
  // Of both stages: with the actor's weights in stage I a skirt that swings turns the thighs, and in stage II its
  // back follows them (docs/experiments.md).
  HangingClothOptions hanging;
  ClothOptions cloth;
  DrapeOptions drape;

  bool solve_pose = true;          // false: stage I ends with its initialisation from each frame's detections alone
  bool enable_surface = true;      // false: the result is the skinned template of stage I
  bool ignore_confidence = false;  // true: every keypoint the network knows counts fully
  bool simulate_cloth = true;      // V^S of hanging cloth in stage II is where it swings to, not where skinning puts it
  bool learn_drape = true;         // where simulated cloth is matched, how it drapes is learned from that
  bool part_mask = true;           // b_i = 0 on another body part's region
  bool snapping = true;
  bool warp_displacements = true;  // carry the non-rigid displacement to the next frame
  // Only cloth, material of at most this rigidity, keeps its displacement: what skin, hair and shoes seem to be
  // displaced by is an error of the pose, and carried on it would stay when the pose is right again.
  float max_carried_rigidity = 3;
  // Of cloth that lies on the body so much is kept per frame: in part it is the pose's error as well, in part what the
  // actor's shape lacks.
  float worn_carried_share = 0.7f;
  // The same of what hangs and is taut, and of what hangs in folds, which open and close (HangingClothOptions::taut,
  // loose).
  float taut_carried_share = 0.9f;
  float loose_carried_share = 0.6f;
  // In stage II what hangs of an actor with a texture is matched with the picture at these resolutions (half of it per
  // level): at the first from where it begins, for the first steps, at each further one from where the step before
  // left it, for one; at most as many as there are steps. What lies on the body is where the pose has it.
  std::vector<int> cloth_match_levels = {2, 1};
  // Where cloth is matched, what the camera does not see of it is drawn to where it would be, had it moved as what it
  // sees of it there: so much of a match's weight, 0 = not.
  float behind_share = 0.005f;
  // Cloth is also matched from where its simulation alone has it; such matches count, where they are better, when their
  // weights sum to this share of those from where last frame's displacement has it. 0: they never count.
  float anew_share = 0.9f;

  // A pose whose mean keypoint error exceeds this fraction of the person's height in the picture is not believed: the
  // frame is solved again from the detections alone, and lost when that does not help.
  double lost_error_fraction = 0.08;
  // A pose that is not believed is kept for so many frames on end after one that was, from the second on only if the
  // picture does not agree better with one that is found anew: networks have single frames in which they see somebody
  // else's limbs, and stage I does not follow these (PoseOptions::keypoint_2d_huber_px).
  int max_doubtful_frames = 3;
  // After a frame in which the network saw nobody, the person is taken up again where the motion would have led for so
  // many frames on end. What is not believed then is nobody: networks go on seeing something where a person just was.
  int max_missed_frames = kMaxMissedFrames;
  // In a frame in which the network sees nobody the silhouette alone is followed, as long as the mesh has this IoU with
  // it.
  double least_missed_iou = 0.75;
  // Who is found is only believed where the mesh has this IoU with the silhouette: networks see people in empty rooms.
  // There it was 0.23 and less, of people in over a thousand captures 0.86 and more; who is seen from the waist up has
  // half of that.
  double least_found_iou = 0.35;

  // Of all but what others validate: PoseOptions, MatchOptions, ... Throws ConfigError naming field, value and range.
  void validate() const;
};

}  // namespace livecap
