// Hand-computed cases on a figure that stands straight: camera axes, x right, y down, z away from the camera.
#include "detect/posture.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>

#include "livecap/error.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using detect::Posture;
using detect::PostureOptions;
using Keypoints = std::array<KeypointDetection, kKeypointCount>;

constexpr double kRad = std::numbers::pi / 180;
constexpr double kFacing = 0, kAway = 180 * kRad, kSideways = 90 * kRad;
constexpr double kInstant = 1e-9;  // s; too short for the camera's tilt to change
constexpr double kTrunkMm = 500, kThighMm = 420;

Eigen::Vector3d at(const Keypoints& k, int i) {
  return {k[i].x_mm, k[i].y_mm, k[i].z_mm};
}

// The trunk's unit vector has this z and lies upright in the picture otherwise. Legs hang straight down.
Keypoints figure(double facing_rad, double lean) {
  const Eigen::Vector3d left(std::cos(facing_rad), 0, std::sin(facing_rad));
  const Eigen::Vector3d front(std::sin(facing_rad), 0, -std::cos(facing_rad));
  const Eigen::Vector3d down(0, 1, 0);
  const Eigen::Vector3d neck = kTrunkMm * Eigen::Vector3d(0, -std::sqrt(1 - lean * lean), lean);
  Keypoints k{};
  const auto place = [&](int i, const Eigen::Vector3d& p) {
    k[i] = {float(i), float(2 * i), float(p.x()), float(p.y()), float(p.z()), 0.5f};
  };
  place(kPelvis, {0, 0, 0});
  place(kNeck, neck);
  place(kHeadTop, neck - 250 * down);
  place(kNose, neck - 120 * down + 110 * front);
  place(kChin, neck - 60 * down + 90 * front);
  for (int side : {0, 1}) {
    const Eigen::Vector3d out = side == 0 ? left : Eigen::Vector3d(-left);
    place(kLeftEye + side, neck - 150 * down + 90 * front + 30 * out);
    place(kLeftShoulder + side, neck + 180 * out);
    place(kLeftElbow + side, neck + 180 * out + 280 * down);
    place(kLeftWrist + side, neck + 180 * out + 280 * down + 260 * front);
    place(kLeftHand + side, neck + 180 * out + 280 * down + 350 * front);
    place(kLeftHip + side, 95 * out);
    place(kLeftKnee + side, 95 * out + kThighMm * down);
    place(kLeftAnkle + side, 95 * out + (kThighMm + 410) * down);
    place(kLeftToe + side, 95 * out + (kThighMm + 460) * down + 150 * front);
  }
  return k;
}

void set_position(KeypointDetection& k, const Eigen::Vector3d& p) {
  k.x_mm = float(p.x());
  k.y_mm = float(p.y());
  k.z_mm = float(p.z());
}

Keypoints turned(Keypoints k, const Eigen::Matrix3d& rotation) {
  for (int i = 0; i < kKeypointCount; ++i) set_position(k[i], rotation * at(k, i));
  return k;
}

Keypoints corrected(Keypoints k, double dt_s = kInstant) {
  Posture().update({}, dt_s, k);
  return k;
}

PostureOptions trunk_only() {
  PostureOptions options;
  options.thigh = options.upper_arm = options.forearm = {};
  return options;
}

Keypoints corrected(Keypoints k, const PostureOptions& options) {
  Posture().update(options, kInstant, k);
  return k;
}

double lean_of(const Keypoints& k) {
  return (at(k, kNeck) - at(k, kPelvis)).normalized().z();
}

void expect_same(const Keypoints& a, const Keypoints& b) {
  for (int i = 0; i < kKeypointCount; ++i) {
    EXPECT_EQ(a[i].x_mm, b[i].x_mm) << i;
    EXPECT_EQ(a[i].y_mm, b[i].y_mm) << i;
    EXPECT_EQ(a[i].z_mm, b[i].z_mm) << i;
  }
}

// cos = sqrt(1 - 0.2^2) = 0.9797959 of the front's unit vector points along the camera's axis, the usual lean is 0.08
// of that.
TEST(Posture, ALeanWithinTheDeadZoneBecomesTheUsualOne) {
  EXPECT_NEAR(lean_of(corrected(figure(kFacing, -0.2))), -0.0783837, test::kHandComputed);
  EXPECT_NEAR(lean_of(corrected(figure(kFacing, 0.1))), -0.0795990, test::kHandComputed);  // 0.08 * sqrt(0.99)
  EXPECT_NEAR(lean_of(corrected(figure(kAway, 0.2))), 0.0783837, test::kHandComputed);
  EXPECT_NEAR(lean_of(corrected(figure(kAway, -0.1))), 0.0795990, test::kHandComputed);
  EXPECT_NEAR(lean_of(corrected(figure(kSideways, 0.2))), 0, test::kHandComputed);
  EXPECT_NEAR(lean_of(corrected(figure(-kSideways, -0.2))), 0, test::kHandComputed);
}

TEST(Posture, BeyondTheDeadZoneALeanStays) {
  // 80 degrees towards the camera: sin = 0.9848078, less 0.25.
  EXPECT_NEAR(lean_of(corrected(figure(kFacing, -std::sin(80 * kRad)))), -0.7348078, test::kHandComputed);
  EXPECT_NEAR(lean_of(corrected(figure(kAway, std::sin(80 * kRad)))), 0.7348078, test::kHandComputed);
  EXPECT_NEAR(lean_of(corrected(figure(kSideways, 0.5))), 0.25, test::kHandComputed);
  // A bow across the picture has no lean along the camera's axis.
  const Eigen::Matrix3d bow = Eigen::AngleAxisd(kSideways, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  Keypoints k = figure(kSideways, 0);
  for (int i : {kNeck, kLeftShoulder, kRightShoulder}) set_position(k[i], bow * at(k, i));
  EXPECT_NEAR(lean_of(corrected(k)), 0, test::kHandComputed);
  EXPECT_NEAR((at(corrected(k, trunk_only()), kNeck) - at(k, kNeck)).norm(), 0, test::kMillimetreFloat);
}

TEST(Posture, WhatHangsOnTheTrunkGoesAlong) {
  const Keypoints before = figure(kFacing, -0.2), after = corrected(before, trunk_only());
  // From (0, -0.9797959, -0.2) to (0, -sqrt(1 - 0.0783837^2), -0.0783837), times 500 mm.
  const Eigen::Vector3d move(0, -8.563826, 60.808164);
  for (int i : {kNeck, kHeadTop, kLeftShoulder, kRightShoulder, kLeftElbow, kRightElbow, kLeftWrist, kRightWrist,
                kLeftHand, kRightHand, kLeftEye, kRightEye, kNose, kChin})
    EXPECT_NEAR((at(after, i) - at(before, i) - move).norm(), 0, test::kMillimetreFloat) << i;
  for (int i : {kPelvis, kLeftHip, kRightHip}) EXPECT_EQ(at(after, i), at(before, i)) << i;
  for (int i = 0; i < kKeypointCount; ++i) {
    EXPECT_EQ(after[i].x_px, before[i].x_px) << i;
    EXPECT_EQ(after[i].y_px, before[i].y_px) << i;
    EXPECT_EQ(after[i].confidence, before[i].confidence) << i;
  }
}

// A hanging thigh, (0, -1, 0) in the trunk's axes, plus (0.3, 0, 0.4): 420 mm along (0.3, -1, 0.4) / sqrt(1.25).
TEST(Posture, ThighsTurnInTheTrunksAxes) {
  PostureOptions options = trunk_only();
  options.thigh = {0.3, 0, 0.4};
  options.usual_forward_lean = 0;
  const double unit_mm = kThighMm / std::sqrt(1.25);
  for (double facing_rad : {kFacing, kAway, kSideways}) {
    const Eigen::Vector3d left(std::cos(facing_rad), 0, std::sin(facing_rad));
    const Eigen::Vector3d front(std::sin(facing_rad), 0, -std::cos(facing_rad));
    const Keypoints before = figure(facing_rad, 0), after = corrected(before, options);
    for (int side : {0, 1}) {
      const Eigen::Vector3d knee =
          (side ? -0.3 : 0.3) * unit_mm * left + 0.4 * unit_mm * front + Eigen::Vector3d(0, unit_mm, 0);
      EXPECT_NEAR((at(after, kLeftKnee + side) - at(after, kLeftHip + side) - knee).norm(), 0, test::kMillimetreFloat);
      const Eigen::Vector3d moved = at(after, kLeftKnee + side) - at(before, kLeftKnee + side);
      for (int i : {kLeftAnkle, kLeftToe})
        EXPECT_NEAR((at(after, i + side) - at(before, i + side) - moved).norm(), 0, test::kMillimetreFloat) << i;
    }
  }
}

// A hanging upper arm of 280 mm gets (0.5, -1, 0) / sqrt(1.25); a forearm of 260 mm to the front (0, 0.75, 1) / 1.25.
TEST(Posture, ArmsTurnInTheTrunksAxes) {
  PostureOptions options = trunk_only();
  options.upper_arm = {0.5, 0, 0};
  options.forearm = {0, 0.75, 0};
  options.usual_forward_lean = 0;
  const Keypoints after = corrected(figure(kFacing, 0), options);
  for (int side : {0, 1}) {
    const double out = side ? -1 : 1;
    const Eigen::Vector3d upper(out * 125.219806, 250.439613, 0), fore(0, -156, -208);
    EXPECT_NEAR((at(after, kLeftElbow + side) - at(after, kLeftShoulder + side) - upper).norm(), 0,
                test::kMillimetreFloat);
    EXPECT_NEAR((at(after, kLeftWrist + side) - at(after, kLeftElbow + side) - fore).norm(), 0, test::kMillimetreFloat);
  }
}

TEST(Posture, LengthsStay) {
  const std::pair<int, int> bones[] = {{kPelvis, kNeck},
                                       {kNeck, kHeadTop},
                                       {kNeck, kLeftShoulder},
                                       {kNeck, kRightShoulder},
                                       {kNeck, kNose},
                                       {kLeftShoulder, kLeftElbow},
                                       {kRightShoulder, kRightElbow},
                                       {kLeftElbow, kLeftWrist},
                                       {kRightElbow, kRightWrist},
                                       {kLeftWrist, kLeftHand},
                                       {kRightWrist, kRightHand},
                                       {kPelvis, kLeftHip},
                                       {kPelvis, kRightHip},
                                       {kLeftHip, kLeftKnee},
                                       {kRightHip, kRightKnee},
                                       {kLeftKnee, kLeftAnkle},
                                       {kRightKnee, kRightAnkle},
                                       {kLeftAnkle, kLeftToe},
                                       {kRightAnkle, kRightToe},
                                       {kNose, kChin},
                                       {kLeftEye, kRightEye}};
  const auto check = [&](const Keypoints& before) {
    const Keypoints after = corrected(before);
    for (const auto& [a, b] : bones)
      EXPECT_NEAR((at(after, a) - at(after, b)).norm(), (at(before, a) - at(before, b)).norm(), test::kMillimetreFloat)
          << a << " " << b;
  };
  for (double facing = 0; facing < 6; facing += 0.4) {
    for (double lean : {-0.995, -0.6, -0.2, 0.0, 0.3, 0.8, 1.0}) {
      SCOPED_TRACE(lean);
      check(figure(facing, lean));
    }
  }
  // Sitting, one thigh straight and one nearly straight towards the camera.
  Keypoints sitting = figure(kFacing, 0);
  set_position(sitting[kLeftKnee], at(sitting, kLeftHip) - Eigen::Vector3d(0, 0, kThighMm));
  set_position(sitting[kRightKnee], at(sitting, kRightHip) + Eigen::Vector3d(0, 10, -kThighMm));
  check(sitting);
}

// Tilted by 20 degrees; after camera_memory_s = 10 less the half second that cameras count as level, 95 % of the tilt
// is known: 38 steps of a quarter of a second, the average's weights telescope to 1 - 0.5 / 10.
TEST(Posture, LeansAreRelativeToTheTiltedVertical) {
  const Eigen::Matrix3d tilt = Eigen::AngleAxisd(20 * kRad, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const auto settled = [&](double facing_rad) {
    Posture posture;
    for (int i = 0; i < 38; ++i) {
      Keypoints k = turned(figure(facing_rad, 0), tilt);
      posture.update({}, 0.25, k);
    }
    return posture;
  };
  const auto lean_after = [](Posture posture, Keypoints k) {
    posture.update({}, kInstant, k);
    return lean_of(k);
  };
  // Sideways: 0.95 * -sin(20 deg), whatever the lean within the dead zone.
  Posture sideways = settled(kSideways);
  for (double lean : {-0.34202014, -0.1, -0.5})
    EXPECT_NEAR(lean_after(sideways, figure(kSideways, lean)), -0.3249191, test::kHandComputed) << lean;
  EXPECT_NEAR(lean_after(sideways, figure(kSideways, 0)), -0.25, test::kHandComputed);  // beyond by 0.0749191
  // Facing: the front's z is -cos(20 deg) = -0.9396926, so 0.95 * (-0.3420201 + 0.16 * 0.9396926) - 0.08 * 0.9396926.
  EXPECT_NEAR(lean_after(settled(kFacing), turned(figure(kFacing, 0), tilt)), -0.2572613, test::kHandComputed);

  sideways.reset();
  EXPECT_NEAR(lean_after(sideways, figure(kSideways, -0.34202014)), -0.0920201, test::kHandComputed);
}

TEST(Posture, NothingToGoByChangesNothing) {
  expect_same(corrected(Keypoints{}, 1.0 / 30), Keypoints{});
  Keypoints line = figure(kFacing, 0);  // no width: it faces nowhere
  for (int i = 0; i < kKeypointCount; ++i) line[i].x_mm = 0;
  expect_same(corrected(line), line);
}

TEST(Posture, WhatIsNoNumberSpoilsNothingElse) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Keypoints good = figure(kFacing, -0.2);
  Posture posture;
  for (int i : {kNeck, kPelvis, kLeftHip, kRightShoulder}) {
    Keypoints k = good;
    k[i].z_mm = nan;
    posture.update({}, 1.0 / 30, k);
    EXPECT_EQ(k[kLeftWrist].z_mm, good[kLeftWrist].z_mm) << i;
    EXPECT_EQ(k[kRightKnee].z_mm, good[kRightKnee].z_mm) << i;
  }
  Keypoints k = good;
  k[kLeftKnee].y_mm = nan;
  posture.update({}, kInstant, k);
  expect_same({k[kNeck], k[kRightKnee], k[kRightToe], k[kLeftToe]},
              {corrected(good)[kNeck], corrected(good)[kRightKnee], corrected(good)[kRightToe], good[kLeftToe]});
}

TEST(Posture, BadOptionsAreNamed) {
  const std::pair<const char*, std::function<void(PostureOptions&)>> cases[] = {
      {"lean_dead_zone", [](PostureOptions& o) { o.lean_dead_zone = -0.1; }},
      {"seen_forward_lean", [](PostureOptions& o) { o.seen_forward_lean = 1.5; }},
      {"usual_forward_lean", [](PostureOptions& o) { o.usual_forward_lean = NAN; }},
      {"thigh", [](PostureOptions& o) { o.thigh.forward = INFINITY; }},
      {"upper_arm", [](PostureOptions& o) { o.upper_arm.outward = -1.5; }},
      {"forearm", [](PostureOptions& o) { o.forearm.upward = NAN; }},
      {"camera_memory_s", [](PostureOptions& o) { o.camera_memory_s = 0; }},
      {"camera_level_s", [](PostureOptions& o) { o.camera_level_s = INFINITY; }},
  };
  EXPECT_NO_THROW(PostureOptions().validate());
  for (const auto& [field, spoil] : cases) {
    PostureOptions options;
    spoil(options);
    try {
      options.validate();
      ADD_FAILURE() << field << " was accepted";
    } catch (const ConfigError& e) {
      EXPECT_NE(std::string(e.what()).find(field), std::string::npos) << e.what();
    }
  }
}

}  // namespace
}  // namespace livecap
