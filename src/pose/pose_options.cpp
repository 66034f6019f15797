#include "pose/pose_options.h"

#include <cmath>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {

namespace {

// Points whose place on the actor is known less well than that of joints.
constexpr Keypoint kLoose[] = {kLeftEye, kRightEye, kNose, kChin, kLeftHand, kRightHand, kLeftToe, kRightToe};

}  // namespace

bool set_weight(PoseWeights& weights, std::string_view term, double value) {
  if (term == "keypoint_2d") return weights.keypoint_2d = value, true;
  if (term == "keypoint_3d") return weights.keypoint_3d = value, true;
  if (term == "pose_silhouette") return weights.silhouette = value, true;
  if (term == "match") return weights.match = value, true;
  if (term == "shading") return weights.shading = value, true;
  if (term == "floor") return weights.floor = value, true;
  if (term == "temporal") return weights.temporal = value, true;
  if (term == "anatomic") return weights.anatomic = value, true;
  if (term == "rest") return weights.rest = value, true;
  return false;
}

std::array<double, kKeypointCount> default_keypoint_2d_weights() {
  std::array<double, kKeypointCount> weights;
  weights.fill(1.0);
  for (int k : kLoose) weights[k] = 0.326;
  return weights;
}

std::array<double, kKeypointCount> default_keypoint_3d_weights() {
  std::array<double, kKeypointCount> weights;
  weights.fill(0.35);
  for (int k : {kNeck, kPelvis, kLeftHip, kRightHip, kLeftShoulder, kRightShoulder}) weights[k] = 1.75;
  for (int k : kLoose) weights[k] = 0.115;
  return weights;
}

std::array<double, kKeypointCount> default_temporal_weights() {
  std::array<double, kKeypointCount> weights;
  weights.fill(0.0);
  for (int k : {kHeadTop, kNeck, kPelvis, kLeftHip, kRightHip}) weights[k] = 2.5;
  for (int k : {kLeftShoulder, kRightShoulder}) weights[k] = 2.0;
  for (int k : {kLeftElbow, kRightElbow, kLeftKnee, kRightKnee}) weights[k] = 1.5;
  for (int k : {kLeftWrist, kRightWrist, kLeftHand, kRightHand, kLeftAnkle, kRightAnkle, kLeftToe, kRightToe})
    weights[k] = 1.0;
  return weights;
}

void PoseOptions::validate() const {
  const auto not_negative = [](const char* field, double value) {
    if (!(value >= 0) || !std::isfinite(value))
      throw ConfigError(format("pose option %s is %g; it must be finite and not negative", field, value));
  };
  const auto share = [](const char* field, double value) {
    if (!(value >= 0 && value <= 1))
      throw ConfigError(format("pose option %s is %g; it must be from 0 to 1", field, value));
  };
  const auto in_range = [](const char* field, int value, int low, int high) {
    if (value < low || value > high)
      throw ConfigError(format("pose option %s is %d; it must be in %d..%d", field, value, low, high));
  };
  not_negative("weights.keypoint_2d", weights.keypoint_2d);
  not_negative("weights.keypoint_3d", weights.keypoint_3d);
  not_negative("weights.silhouette", weights.silhouette);
  not_negative("weights.match", weights.match);
  not_negative("weights.shading", weights.shading);
  not_negative("weights.floor", weights.floor);
  not_negative("weights.temporal", weights.temporal);
  not_negative("weights.anatomic", weights.anatomic);
  not_negative("weights.rest", weights.rest);
  for (double weight : keypoint_2d_weights) not_negative("keypoint_2d_weights", weight);
  for (double weight : keypoint_3d_weights) not_negative("keypoint_3d_weights", weight);
  for (double weight : temporal_weights) not_negative("temporal_weights", weight);
  not_negative("damping_own", damping_own);
  not_negative("damping_largest", damping_largest);
  not_negative("max_step_rad", max_step_rad);
  not_negative("keypoint_2d_huber_px", keypoint_2d_huber_px);
  not_negative("silhouette_huber_px", silhouette_huber_px);
  not_negative("match_huber_px", match_huber_px);
  not_negative("shading_huber", shading_huber);
  not_negative("floor_huber_mm", floor_huber_mm);
  not_negative("temporal_doubt_mm", temporal_doubt_mm);
  share("least_stands", least_stands);
  share("hidden_confidence", hidden_confidence);
  not_negative("hidden_share", hidden_share);
  not_negative("max_predicted_turn_rad", max_predicted_turn_rad);
  not_negative("max_predicted_move_mm", max_predicted_move_mm);
  in_range("steps", steps, 1, 1000);
  in_range("first_steps", first_steps, 1, 1000);
  in_range("max_matches", max_matches, 1, 65536);
  in_range("max_shaded", max_shaded, 1, 65536);
  in_range("max_contour_vertices", max_contour_vertices, 1, 65536);
}

}  // namespace livecap
