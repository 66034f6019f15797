// Options of the pose stage (paper, "Skeletal Pose Estimation"; weights from section "Results").
#pragma once

#include <array>
#include <string_view>

#include "base/detections.h"

namespace livecap {

// Factors of the squared residuals. They only make sense in px, mm and rad. Weight 0 switches a term off.
struct PoseWeights {
  double keypoint_2d = 460;  // lambda_2D
  double keypoint_3d = 28;   // lambda_3D
  double silhouette = 1300;  // lambda_silhouette; the paper: 200
  double match = 2650;       // lambda_match; not in the paper
  double shading = 3e4;      // lambda_shading; not in the paper
  double floor = 200;        // lambda_floor; not in the paper
  double temporal = 1.5;     // lambda_temporal
  double anatomic = 1e7;     // lambda_anatomic; the paper: 1e6
  double rest = 3e6;         // lambda_rest; not in the paper
};

// Sets the weight of a term by its name in solve/term_table.h; false when the pose stage has no such term.
bool set_weight(PoseWeights& weights, std::string_view term, double value);

// lambda_i of E_2D: 0.326 for the face (as in the paper), and for hands and toes, whose place in the hand or on the
// foot differs from network to actor; 1 for the rest.
std::array<double, kKeypointCount> default_keypoint_2d_weights();

// lambda_i of E_temporal: torso, head, hips 2.5; shoulders 2; knees, elbows 1.5; wrists, hands, ankles, toes 1; face 0.
std::array<double, kKeypointCount> default_temporal_weights();

// lambda_i of E_3D: torso (neck, pelvis, hips, shoulders) 1.75, limbs 0.35, face, hands and toes a third of that as in
// E_2D. The paper has none and no face here. A network's depth of a limb is off by a quarter to a half of its length,
// its 2D points by a few px: with 1 the limbs followed the wrong depth against the picture. Where the torso faces is
// known better, and with no more weight than a limb's some 450 contour vertices outweigh it: in a turn the trunk lags
// behind while hips, clavicles and neck twist against their limits.
std::array<double, kKeypointCount> default_keypoint_3d_weights();

struct PoseOptions {
  PoseWeights weights;
  std::array<double, kKeypointCount> keypoint_3d_weights = default_keypoint_3d_weights();
  std::array<double, kKeypointCount> keypoint_2d_weights = default_keypoint_2d_weights();
  std::array<double, kKeypointCount> temporal_weights = default_temporal_weights();

  int steps = 6;         // Gauss-Newton steps of a tracked frame
  int first_steps = 20;  // of the first frame and after a loss

  // 3D detections are re-boned with the template's lengths. false: they already have the actor's size.
  bool rebone = true;

  // More are thinned, and the term keeps its total weight. The camera sees fewer of the built-in figures (5,000
  // vertices): thinned ones tell less, and a match whose weight changes in its last bits changes which others are
  // taken.
  int max_contour_vertices = 1024;
  int max_matches = 2560;
  int max_shaded = 512;

  // Levenberg damping of each unknown, as a share of its own diagonal entry and of the largest diagonal entry among the
  // unknowns of its unit (rad or mm). Tiny: it only keeps unobserved unknowns (a straight arm's twist) where they are.
  double damping_own = 1e-6;
  double damping_largest = 1e-6;

  // A step that turns any joint or the root further is shortened as a whole. Far from the solution Gauss-Newton steps
  // are meaningless beyond this; a tracked frame never reaches it.
  double max_step_rad = 0.8;

  // Residual length from which a 2D keypoint or a contour vertex pulls linearly (Huber) instead of quadratically.
  // 0 = never, as in the paper. Keypoints that jump and cloth that left the skinned surface must not take the body
  // along.
  double keypoint_2d_huber_px = 12;
  double silhouette_huber_px = 1.5;
  // Where a pose follows none, of the level that was matched at. Some patches were moved onto something similar, 1.5 to
  // 3 px away; at the true pose half of those on shoes are within 0.5 px.
  double match_huber_px = 0.6;
  double shading_huber = 3;    // standard deviations; shadows and highlights
  double floor_huber_mm = 20;  // a step, a floor thought too high

  // How sure E_floor is, at least, that a sole rests on the floor, 0..1 (pose/floor.h: standing).
  double least_stands = 0;

  // Where arms compete, E_temporal of a keypoint grows no further than this far from where it was (pose/targets.h:
  // doubted_cost): the wrong arm of the last frame would hold itself there. 0: it grows for ever.
  double temporal_doubt_mm = 200;

  // What of an arm is not detected with so much confidence keeps its angles, by E_rest of so many chests
  // (pose/held_arms.h).
  double hidden_confidence = 0.3;
  double hidden_share = 3;

  // Bounds of the Euler step that predicts a frame, per frame.
  double max_predicted_turn_rad = 0.5;
  double max_predicted_move_mm = 250;

  // Throws ConfigError naming the field when a value is negative, not finite, or a share or a count is out of range.
  void validate() const;
};

}  // namespace livecap
