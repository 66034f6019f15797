// The poses of a turn of spheres, drawn here ray by ray.
#include "views/turn_silhouettes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/tolerances.h"

namespace livecap {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kTiltDegree = M_PI / 180;

struct Ball {
  Vector3d center;  // of the body, mm, +Y up
  double radius;
};

// Head, trunk, arms to the sides, legs: nothing that looks the same from all around.
const std::vector<Ball> kBody = {{{0, 700, 20}, 110},    {{0, 450, 0}, 130},      {{30, 250, 10}, 140},
                                 {{0, 50, -10}, 130},    {{250, 350, 0}, 60},     {{420, 260, -40}, 50},
                                 {{580, 160, 60}, 45},   {{-250, 380, 30}, 60},   {{-430, 300, 0}, 50},
                                 {{-600, 250, -50}, 45}, {{110, -200, 20}, 90},   {{120, -450, 40}, 70},
                                 {{130, -700, 0}, 60},   {{140, -830, 80}, 50},   {{-110, -200, -10}, 90},
                                 {{-120, -450, 0}, 70},  {{-150, -700, -30}, 60}, {{-160, -830, 50}, 50}};

Quaterniond turned(double degrees, const Vector3d& about) {
  return Quaterniond(Eigen::AngleAxisd(degrees * kTiltDegree, about));
}

// 24 views of one turn, the camera pitched by 4 degrees and rolled by 1.
Turn true_turn() {
  Turn turn;
  turn.axis = turned(4, Vector3d::UnitX()) * turned(1, Vector3d::UnitZ()) * turn.axis;
  turn.center_mm = {40, 20, 2900};
  for (int i = 0; i < 24; ++i) turn.angle_rad.push_back(i * 15 * kTiltDegree);
  turn.deviation.resize(24);
  return turn;
}

std::vector<View> pictures_of(const Turn& turn) {
  std::vector<View> views;
  for (size_t i = 0; i < turn.angle_rad.size(); ++i) {
    View view;
    view.camera = camera_from_fov(360, 480, 46);
    view.mask = {360, 480, std::vector<uint8_t>(360 * 480, 0)};
    std::vector<Vector3d> centers;
    for (const Ball& ball : kBody) centers.push_back(turn.camera_from_body(static_cast<int>(i)) * ball.center);
    for (int y = 0; y < 480; ++y)
      for (int x = 0; x < 360; ++x) {
        const Vector3d ray =
            Vector3d((x - view.camera.cx) / view.camera.fx, (y - view.camera.cy) / view.camera.fy, 1).normalized();
        for (size_t k = 0; k < kBody.size(); ++k)
          if (centers[k].cross(ray).norm() < kBody[k].radius) view.mask.pixels[size_t(y) * 360 + x] = 255;
      }
    views.push_back(view);
  }
  return views;
}

// How far the poses of a turn contradict the true ones about where points of the body are, rms, mm. Where the body's
// own axes are does not matter.
double contradiction_mm(const Turn& turn, const Turn& truth) {
  double sum = 0;
  const int n = static_cast<int>(truth.angle_rad.size());
  for (const Ball& ball : kBody) {
    std::vector<Vector3d> places;
    Vector3d mean = Vector3d::Zero();
    for (int i = 0; i < n; ++i) {
      places.push_back(turn.camera_from_body(i).inverse() * (truth.camera_from_body(i) * ball.center));
      mean += places.back() / n;
    }
    for (const Vector3d& place : places) sum += (place - mean).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(n * kBody.size()));
}

// The axis tilted, and a drift over the turn: yaw and shift.
Turn disturbed(Turn turn, double about_x, double about_z, double drift_deg, double drift_mm) {
  turn.axis = turned(about_x, Vector3d::UnitX()) * turned(about_z, Vector3d::UnitZ()) * turn.axis;
  for (size_t i = 0; i < turn.angle_rad.size(); ++i) {
    const double s = std::sin(turn.angle_rad[i] + 0.4);
    turn.angle_rad[i] += drift_deg * kTiltDegree * s;
    turn.deviation[i].shift_mm = drift_mm * Vector3d(s, 0.3 * s, -s);
  }
  return turn;
}

TEST(TurnSilhouettes, AlignThePoses) {
  const Turn truth = true_turn();
  std::vector<View> views = pictures_of(truth);
  views[3].mask = {};  // a view in which the network saw nobody
  for (const auto& start : {disturbed(truth, 1.2, -0.8, 0, 0), disturbed(truth, -1, 0.6, 0, 0),
                            disturbed(truth, 0, 0, 1.5, 0), disturbed(truth, 0.4, 0.2, -1, 6)}) {
    Turn turn = start;
    align_turn_by_silhouettes(views, turn);
    EXPECT_LT(contradiction_mm(turn, truth), test::kSilhouettePosesMm);
    EXPECT_LT(contradiction_mm(turn, truth), contradiction_mm(start, truth) / 2);
  }
}

TEST(TurnSilhouettes, RightPosesStay) {
  const Turn truth = true_turn();
  Turn turn = truth;
  align_turn_by_silhouettes(pictures_of(truth), turn);
  EXPECT_LT(contradiction_mm(turn, truth), test::kSilhouettePosesMm);
}

TEST(TurnSilhouettes, MasksThatSayNothingLeaveThePoses) {
  const Turn truth = true_turn();
  std::vector<View> views = pictures_of(truth);
  for (View& view : views) std::fill(view.mask.pixels.begin(), view.mask.pixels.end(), uint8_t{255});
  Turn turn = truth;
  align_turn_by_silhouettes(views, turn);
  EXPECT_EQ(contradiction_mm(turn, truth), contradiction_mm(truth, truth));
}

}  // namespace
}  // namespace livecap
