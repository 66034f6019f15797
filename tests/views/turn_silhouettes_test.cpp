// The axis of a turn of spheres, drawn here ray by ray.
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
    view.camera = camera_from_fov(240, 320, 46);
    view.mask = {240, 320, std::vector<uint8_t>(240 * 320, 0)};
    std::vector<Vector3d> centers;
    for (const Ball& ball : kBody) centers.push_back(turn.camera_from_body(static_cast<int>(i)) * ball.center);
    for (int y = 0; y < 320; ++y)
      for (int x = 0; x < 240; ++x) {
        const Vector3d ray =
            Vector3d((x - view.camera.cx) / view.camera.fx, (y - view.camera.cy) / view.camera.fy, 1).normalized();
        for (size_t k = 0; k < kBody.size(); ++k)
          if (centers[k].cross(ray).norm() < kBody[k].radius) view.mask.pixels[size_t(y) * 240 + x] = 255;
      }
    views.push_back(view);
  }
  return views;
}

double apart_rad(const Turn& a, const Turn& b) {
  return (a.axis * Vector3d::UnitY()).cross(b.axis * Vector3d::UnitY()).norm();
}

TEST(TurnSilhouettes, TiltTheAxisBack) {
  const Turn truth = true_turn();
  std::vector<View> views = pictures_of(truth);
  views[3].mask = {};  // a view in which the network saw nobody
  for (const auto& [about_x, about_z] : {std::pair{0.8, -0.5}, {-0.7, 0.4}, {0.0, 0.0}}) {
    Turn turn = truth;
    turn.axis = turned(about_x, Vector3d::UnitX()) * turned(about_z, Vector3d::UnitZ()) * turn.axis;
    tilt_axis_by_silhouettes(views, turn);
    EXPECT_LT(apart_rad(turn, truth), test::kSilhouetteAxisRad) << about_x << " " << about_z;
    EXPECT_EQ(turn.center_mm, truth.center_mm);
  }
}

TEST(TurnSilhouettes, MasksThatSayNothingLeaveTheAxis) {
  const Turn truth = true_turn();
  std::vector<View> views = pictures_of(truth);
  for (View& view : views) std::fill(view.mask.pixels.begin(), view.mask.pixels.end(), uint8_t{255});
  Turn turn = truth;
  tilt_axis_by_silhouettes(views, turn);
  EXPECT_EQ(apart_rad(turn, truth), 0);
}

}  // namespace
}  // namespace livecap
