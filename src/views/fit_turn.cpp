#include "views/fit_turn.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/median.h"
#include "base/text.h"
#include "livecap/error.h"
#include "views/turn_silhouettes.h"
#include "views/turn_tracks.h"
#include "views/turntable.h"

namespace livecap {

namespace {

using Eigen::Vector3d;

constexpr double kMinConfidence = 0.3;
constexpr double kKeypointRad = 0.012;  // how far keypoints are beside a rigid body
constexpr double kClosedRad = 0.35;     // the last view is followed by the first
constexpr double kMovedShare = 0.12;    // of the body's height: a limb that far off has moved
constexpr double kMovedViews = 0.15;    // of the views
constexpr double kFacesAway = -0.3;     // cosine of the angle between network and turn: sides are exchanged
constexpr int kNeighbors = 4;
constexpr double kSideOn = 0.3;  // cosine of the angle
constexpr int kFewTracks = 200;
constexpr std::array<std::pair<int, int>, 8> kSides = {{{kLeftHip, kRightHip},
                                                        {kLeftShoulder, kRightShoulder},
                                                        {kLeftElbow, kRightElbow},
                                                        {kLeftWrist, kRightWrist},
                                                        {kLeftHand, kRightHand},
                                                        {kLeftKnee, kRightKnee},
                                                        {kLeftAnkle, kRightAnkle},
                                                        {kLeftToe, kRightToe}}};

// The body at angle 0 as the mean of the network's, and how far away it is.
Turn first_guess(const Camera& camera, const std::vector<Detections>& detections, const std::vector<double>& angle) {
  Turn turn;
  turn.angle_rad = angle;
  turn.deviation.resize(angle.size());
  turn.points_mm.assign(kKeypointCount, Vector3d::Zero());
  std::vector<double> weight(kKeypointCount, 0), depths, xs, ys;
  for (size_t i = 0; i < detections.size(); ++i) {
    const Detections& seen = detections[i];
    if (!seen.person) continue;
    const Eigen::Quaterniond body_from_camera =
        (turn.axis * Eigen::AngleAxisd(angle[i], Vector3d::UnitY())).conjugate();
    for (int k = 0; k < kKeypointCount; ++k) {
      const KeypointDetection& p = seen.keypoints[k];
      if (p.confidence < kMinConfidence) continue;
      turn.points_mm[k] += p.confidence * (body_from_camera * Vector3d(p.x_mm, p.y_mm, p.z_mm));
      weight[k] += p.confidence;
    }
    const auto& p = seen.keypoints;
    const double top_mm = (p[kLeftShoulder].y_mm + p[kRightShoulder].y_mm) / 2,
                 foot_mm = (p[kLeftAnkle].y_mm + p[kRightAnkle].y_mm) / 2;
    const double top_px = (p[kLeftShoulder].y_px + p[kRightShoulder].y_px) / 2,
                 foot_px = (p[kLeftAnkle].y_px + p[kRightAnkle].y_px) / 2;
    if (foot_px - top_px > 1 && foot_mm > top_mm) depths.push_back(camera.fy * (foot_mm - top_mm) / (foot_px - top_px));
    xs.push_back((p[kLeftHip].x_px + p[kRightHip].x_px) / 2);
    ys.push_back((p[kLeftHip].y_px + p[kRightHip].y_px) / 2);
  }
  for (int k = 0; k < kKeypointCount; ++k)
    if (weight[k] > 0) turn.points_mm[k] /= weight[k];
  const double depth = depths.empty() ? 3000 : median(depths);
  turn.center_mm = depth * Vector3d((median(xs) - camera.cx) / camera.fx, (median(ys) - camera.cy) / camera.fy, 1);
  return turn;
}

std::vector<TurnObservation> keypoint_observations(const Camera& camera, const std::vector<Detections>& detections) {
  std::vector<TurnObservation> observations;
  for (size_t i = 0; i < detections.size(); ++i) {
    if (!detections[i].person) continue;
    for (int k = 0; k < kKeypointCount; ++k) {
      const KeypointDetection& p = detections[i].keypoints[k];
      if (p.confidence < kMinConfidence) continue;
      observations.push_back(
          {static_cast<int>(i), k, {p.x_px, p.y_px}, kKeypointRad * camera.fx / std::sqrt(p.confidence)});
    }
  }
  return observations;
}

// Limbs are rigid with the trunk, but for the network's errors.
void require_still(const Camera& camera, const std::vector<TurnObservation>& keypoints, const Turn& turn) {
  const double height_mm =
      (turn.points_mm[kNose] - (turn.points_mm[kLeftAnkle] + turn.points_mm[kRightAnkle]) / 2).norm();
  const double far_px = kMovedShare * height_mm * camera.fx / turn.center_mm.z();
  std::array<int, kKeypointCount> n_seen{}, n_far{};
  for (const TurnObservation& seen : keypoints) {
    ++n_seen[seen.point];
    n_far[seen.point] += turn.error_px(camera, seen) > far_px;
  }
  std::string moved;
  for (int k : {kLeftElbow, kRightElbow, kLeftWrist, kRightWrist, kLeftKnee, kRightKnee, kLeftAnkle, kRightAnkle})
    if (n_far[k] > kMovedViews * n_seen[k]) moved += (moved.empty() ? "" : ", ") + std::string(kKeypointNames[k]);
  if (!moved.empty())
    throw ConfigError("the person does not hold still while turning: " + moved +
                      " moved against the body; keep arms and legs as they are and turn as a whole, in small steps");
}

// Robust error of a view's keypoints with the person turned that far.
double view_error(const Camera& camera, const Turn& turn, double angle_rad, const Detections& detections) {
  Turn one;
  one.axis = turn.axis, one.center_mm = turn.center_mm, one.points_mm = turn.points_mm;
  one.deviation.resize(1);
  one.angle_rad = {angle_rad};
  double error = 0;
  for (const TurnObservation& seen : keypoint_observations(camera, {detections}))
    error += std::log1p(std::pow(one.error_px(camera, seen) / seen.sigma_px, 2));
  return error;
}

// Views that clearly fit better with left and right exchanged, where their neighbours in the turn have the person;
// returns how many. From the side both look alike.
int exchange_worse_sides(const Camera& camera, const Turn& turn, const std::vector<double>& angle_rad,
                         std::vector<Detections>& detections) {
  int n_exchanged = 0;
  const int n = static_cast<int>(detections.size());
  for (int i = 0; i < n; ++i) {
    if (!detections[i].person) continue;
    std::vector<double> correction;
    for (int j = std::max(0, i - kNeighbors); j <= std::min(n - 1, i + kNeighbors); ++j)
      correction.push_back(turn.angle_rad[j] - angle_rad[j]);
    const double expected = angle_rad[i] + median(correction);
    if (std::abs(std::cos(expected)) < kSideOn) continue;
    Detections exchanged = detections[i];
    exchange_sides(exchanged);
    if (2 * view_error(camera, turn, expected, exchanged) > view_error(camera, turn, expected, detections[i])) continue;
    detections[i] = exchanged;
    ++n_exchanged;
  }
  return n_exchanged;
}

}  // namespace

void exchange_sides(Detections& detections) {
  for (const auto& [left, right] : kSides) std::swap(detections.keypoints[left], detections.keypoints[right]);
  std::swap(detections.keypoints[kLeftEye], detections.keypoints[kRightEye]);
}

Turn fit_keypoint_turn(const Camera& camera, std::vector<Detections>& detections,
                       const std::vector<double>& angle_rad) {
  for (size_t i = 0; i < detections.size(); ++i)
    if (detections[i].person && std::cos(facing_rad(detections[i]) - angle_rad[i]) < kFacesAway)
      exchange_sides(detections[i]);
  Turn turn;
  std::vector<TurnObservation> keypoints;
  for (int round = 0; round < 3; ++round) {
    turn = first_guess(camera, detections, angle_rad);
    keypoints = keypoint_observations(camera, detections);
    solve_turn(camera, keypoints, {}, turn);
    if (exchange_worse_sides(camera, turn, angle_rad, detections) == 0) break;
  }
  require_still(camera, keypoints, turn);
  return turn;
}

TurnFit fit_turn(std::vector<View>& views, std::vector<Detections>& detections, const std::vector<double>& angle_rad,
                 std::vector<std::string>& notes) {
  const Camera& camera = views.front().camera;
  TurnFit fit;
  fit.turn = fit_keypoint_turn(camera, detections, angle_rad);
  const std::vector<TurnObservation> keypoints = keypoint_observations(camera, detections);
  const double gap = 2 * M_PI - std::abs(fit.turn.angle_rad.back() - fit.turn.angle_rad.front());
  std::vector<TurnObservation> observations = track_turn(views, std::abs(gap) < kClosedRad, kKeypointCount);
  int n_points = kKeypointCount;
  for (const TurnObservation& seen : observations) n_points = std::max(n_points, seen.point + 1);
  fit.n_tracks = n_points - kKeypointCount;
  // Where the tracks' first views see them, on the axis' plane across the view.
  fit.turn.points_mm.resize(n_points, Vector3d::Zero());
  std::vector<char> placed(n_points, 0);
  for (const TurnObservation& seen : observations) {
    if (std::exchange(placed[seen.point], 1)) continue;
    const Vector3d ray((seen.pixel.x() - camera.cx) / camera.fx, (seen.pixel.y() - camera.cy) / camera.fy, 1);
    fit.turn.points_mm[seen.point] =
        fit.turn.camera_from_body(seen.view).inverse() * (ray * (fit.turn.center_mm.z() - 80));
  }
  observations.insert(observations.end(), keypoints.begin(), keypoints.end());
  TurnBundleOptions options;
  options.keep_axis = true;  // the tracks' small common drift would tilt it
  solve_turn(camera, observations, options, fit.turn);
  options.deviate = true;
  solve_turn(camera, observations, options, fit.turn);

  std::vector<double> track_px;
  for (const TurnObservation& seen : observations)
    if (seen.point >= kKeypointCount) track_px.push_back(fit.turn.error_px(camera, seen));
  fit.track_px = median(track_px);
  double sway = 0;
  for (const TurnDeviation& d : fit.turn.deviation)
    sway += d.shift_mm.squaredNorm() / static_cast<double>(views.size());
  fit.sway_mm = std::sqrt(sway);
  if (fit.n_tracks < kFewTracks)
    notes.push_back(
        format("only %d points of the clothes could be followed around: the turn comes from the network's "
               "keypoints, and the shape is coarser",
               fit.n_tracks));
  align_turn_by_silhouettes(views, fit.turn);
  for (size_t i = 0; i < views.size(); ++i) views[i].camera_from_world = fit.turn.camera_from_body(static_cast<int>(i));
  return fit;
}

}  // namespace livecap
