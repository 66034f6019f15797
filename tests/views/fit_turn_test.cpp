// The turn of a known rigid body, projected here by hand.
#include "views/fit_turn.h"

#include <gtest/gtest.h>

#include <cmath>

#include "livecap/error.h"
#include "support/tolerances.h"
#include "views/turn_tracks.h"

namespace livecap {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// A person of 1.7 m: +X their left, +Y up, +Z front, mm from the pelvis.
std::vector<Vector3d> body() {
  std::vector<Vector3d> points(kKeypointCount);
  points[kHeadTop] = {0, 760, 10}, points[kNeck] = {0, 490, -10}, points[kPelvis] = {0, 0, 0};
  points[kLeftHip] = {100, 0, 5}, points[kLeftShoulder] = {180, 480, -15}, points[kLeftElbow] = {390, 330, -30};
  points[kLeftWrist] = {590, 200, 0}, points[kLeftHand] = {650, 150, 20}, points[kLeftKnee] = {120, -420, 15};
  points[kLeftAnkle] = {130, -830, -20}, points[kLeftToe] = {150, -880, 130}, points[kLeftEye] = {30, 660, 95};
  points[kNose] = {0, 630, 120}, points[kChin] = {0, 560, 90};
  for (auto [left, right] : {std::pair{kLeftHip, kRightHip},
                             {kLeftShoulder, kRightShoulder},
                             {kLeftElbow, kRightElbow},
                             {kLeftWrist, kRightWrist},
                             {kLeftHand, kRightHand},
                             {kLeftKnee, kRightKnee},
                             {kLeftAnkle, kRightAnkle},
                             {kLeftToe, kRightToe},
                             {kLeftEye, kRightEye}})
    points[right] = {-points[left].x(), points[left].y(), points[left].z()};
  return points;
}

// A full turn to the left in 40 views, before a camera that looks down a little; the person stands beside the middle.
struct Film {
  std::vector<View> views;
  std::vector<Detections> detections;
  std::vector<double> angle_rad;  // true
  std::vector<Eigen::Isometry3d> camera_from_body;
};

Film film(double noise_px, double arm_mm = 0, int n = 40) {
  Film film;
  const Camera camera = camera_from_fov(480, 640, 46);
  Matrix3d tilt;  // person axes to camera axes at angle 0, the camera pitched by 5 and rolled by 1 degree
  const double pitch = 5 * M_PI / 180, roll = M_PI / 180;
  Matrix3d flip, pitched, rolled;
  flip << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  pitched << 1, 0, 0, 0, std::cos(pitch), -std::sin(pitch), 0, std::sin(pitch), std::cos(pitch);
  rolled << std::cos(roll), -std::sin(roll), 0, std::sin(roll), std::cos(roll), 0, 0, 0, 1;
  tilt = rolled * pitched * flip;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * M_PI * i / n - 0.6;
    Matrix3d turn;
    turn << std::cos(angle), 0, std::sin(angle), 0, 1, 0, -std::sin(angle), 0, std::cos(angle);
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = tilt * turn;
    pose.translation() = Vector3d(60, 130, 2900);
    auto points = body();
    if (arm_mm > 0 && i >= 10 && i < 25)
      for (int k : {kLeftWrist, kLeftHand}) points[k].y() += arm_mm;
    Detections seen;
    seen.person = true;
    seen.score = 1;
    for (int k = 0; k < kKeypointCount; ++k) {
      const Vector3d p = pose * points[k], relative = p - pose * points[kPelvis];
      KeypointDetection& point = seen.keypoints[k];
      point.x_px = static_cast<float>(camera.fx * p.x() / p.z() + camera.cx + noise_px * std::sin(7 * i + 3 * k));
      point.y_px = static_cast<float>(camera.fy * p.y() / p.z() + camera.cy + noise_px * std::cos(5 * i + 4 * k));
      point.x_mm = static_cast<float>(0.93 * relative.x()), point.y_mm = static_cast<float>(0.93 * relative.y());
      point.z_mm = static_cast<float>(0.8 * relative.z());  // networks flatten
      point.confidence = 0.9f;
    }
    View view;
    view.camera = camera;
    view.image = {480, 640, std::vector<uint8_t>(3 * 480 * 640, 90)};
    view.mask = {480, 640, std::vector<uint8_t>(480 * 640, 255)};
    film.views.push_back(view);
    film.detections.push_back(seen);
    film.angle_rad.push_back(angle);
    film.camera_from_body.push_back(pose);
  }
  return film;
}

// As the network: off by up to 20 degrees, depending on the side.
std::vector<double> rough(const std::vector<double>& angle) {
  std::vector<double> result;
  for (double a : angle) result.push_back(a + 0.35 * std::sin(2 * a));
  return result;
}

// Angle between the true and the fitted camera, after the best common turn about the body's axis.
double worst_rad(const Film& film, const std::vector<View>& views) {
  const Matrix3d between = views[0].camera_from_world.linear().transpose() * film.camera_from_body[0].linear();
  double worst = 0;
  for (size_t i = 0; i < views.size(); ++i)
    worst = std::max(worst, Eigen::AngleAxisd(Matrix3d(views[i].camera_from_world.linear() * between *
                                                       film.camera_from_body[i].linear().transpose()))
                                .angle());
  return worst;
}

TEST(FitTurn, ExactKeypointsGiveTheExactTurn) {
  const Film truth = film(0);
  auto detections = truth.detections;
  const Turn turn = fit_keypoint_turn(truth.views[0].camera, detections, rough(truth.angle_rad));
  for (size_t i = 0; i < truth.angle_rad.size(); ++i) {
    const double since = turn.angle_rad[i] - turn.angle_rad[0];
    EXPECT_NEAR(since, truth.angle_rad[i] - truth.angle_rad[0], test::kExactTurnRad) << i;
  }
  // The axis, and the body up to its scale.
  const Vector3d up = turn.axis * Vector3d::UnitY(), true_up = truth.camera_from_body[0].linear().col(1);
  EXPECT_LT(up.cross(true_up).norm(), test::kExactTurnRad);
  const double scale =
      (body()[kNose] - body()[kLeftAnkle]).norm() / (turn.points_mm[kNose] - turn.points_mm[kLeftAnkle]).norm();
  EXPECT_NEAR(scale * (turn.points_mm[kLeftWrist] - turn.points_mm[kRightToe]).norm(),
              (body()[kLeftWrist] - body()[kRightToe]).norm(), test::kExactTurnMm);
}

TEST(FitTurn, PlainPicturesGiveTheTurnOfTheKeypoints) {
  Film truth = film(1.5);
  std::vector<std::string> notes;
  for (int i : {5, 18, 19, 20, 38}) exchange_sides(truth.detections[i]);
  for (int i : {5, 18, 19, 20, 38})  // and the depths with them: the network takes the back for the front
    for (KeypointDetection& point : truth.detections[i].keypoints) point.z_mm = -point.z_mm;
  truth.views[7].mask = {};  // the network saw nobody there
  const TurnFit fit = fit_turn(truth.views, truth.detections, rough(truth.angle_rad), notes);
  EXPECT_LT(worst_rad(truth, truth.views), test::kNoisyTurnRad);
  EXPECT_EQ(fit.n_tracks, 0);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("only 0 points of the clothes"), std::string::npos) << notes[0];
}

TEST(FitTurn, AnArmThatMovesIsToldByName) {
  Film truth = film(1, 420);
  std::vector<std::string> notes;
  try {
    fit_turn(truth.views, truth.detections, rough(truth.angle_rad), notes);
    FAIL() << "a moving arm was taken";
  } catch (const ConfigError& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("does not hold still"), std::string::npos) << what;
    EXPECT_NE(what.find("left_wrist"), std::string::npos) << what;
    EXPECT_EQ(what.find("knee"), std::string::npos) << what;
  }
}

TEST(FitTurn, TracksFollowAPatternAcrossTheEnds) {
  // Four pictures of a pattern that moves by (3, 1) px; the last is followed by the first when the turn is closed.
  std::vector<View> views;
  for (int i = 0; i < 4; ++i) {
    View view;
    view.image = {160, 120, std::vector<uint8_t>(3 * 160 * 120)};
    view.mask = {160, 120, std::vector<uint8_t>(160 * 120, 255)};
    for (int y = 0; y < 120; ++y)
      for (int x = 0; x < 160; ++x)
        for (int c = 0; c < 3; ++c) {
          const double u = x - 3 * i, v = y - i;
          view.image.pixels[3 * (160 * y + x) + c] = static_cast<uint8_t>(
              120 + 60 * std::sin(0.31 * u + 0.11 * v) * std::cos(0.23 * v) + 30 * std::sin(0.7 * u - 0.5 * v));
        }
    views.push_back(view);
  }
  int n_wrapped = 0, n_steps = 0, n_right = 0;
  for (bool closed : {false, true}) {
    const auto seen = track_turn(views, closed, 5);
    ASSERT_GT(seen.size(), 60u);
    for (size_t k = 1; k < seen.size(); ++k) {
      EXPECT_GE(seen[k].point, 5);
      if (seen[k].point != seen[k - 1].point) continue;
      const int step = seen[k].view - seen[k - 1].view;
      if (step < 0) {
        ++n_wrapped;
        EXPECT_TRUE(closed);
        continue;
      }
      ++n_steps;
      n_right += (seen[k].pixel - seen[k - 1].pixel - Eigen::Vector2d(3, 1)).norm() < test::kTrackPx;
    }
  }
  EXPECT_GT(n_wrapped, 0);
  EXPECT_GT(10 * n_right, 9 * n_steps) << n_right << " of " << n_steps;
}

}  // namespace
}  // namespace livecap
