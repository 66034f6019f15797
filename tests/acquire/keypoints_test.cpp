#include "acquire/keypoints.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "acquire/body_rig.h"
#include "acquire/person_frame.h"
#include "livecap/error.h"
#include "support/refusal.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using acquire::Ray;
using acquire::SpacePoint;
using acquire::triangulate;
using Eigen::Vector3d;

// Rays from a circle of cameras to `target`, each off by about noise_rad; the first n_wrong look elsewhere.
std::vector<Ray> rays_to(const Vector3d& target, int n, double noise_rad, int n_wrong, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, noise_rad);
  std::vector<Ray> rays;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * M_PI * i / n;
    const Vector3d center(2800 * std::sin(angle), 1200 + 300 * (i % 3), 2800 * std::cos(angle));
    Vector3d to = (target - center).normalized();
    to += Vector3d(normal(random), normal(random), normal(random));
    if (i < n_wrong) to += 0.15 * (Eigen::AngleAxisd(2.4 * i, to) * to.unitOrthogonal());
    rays.push_back({center, to.normalized(), 1});
  }
  return rays;
}

TEST(Keypoints, TriangulationFindsThePoint) {
  const Vector3d target(150, 1300, -80);
  const SpacePoint exact = triangulate(rays_to(target, 12, 0, 0));
  ASSERT_TRUE(exact.found);
  EXPECT_LT((exact.position - target).norm(), test::kTriangulatedMm);
  EXPECT_EQ(exact.n_inliers, 12);
  // A third of the views see something else; 5 mrad is 14 mm.
  double sum = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const SpacePoint noisy = triangulate(rays_to(target, 60, 0.005, 20, seed));
    ASSERT_TRUE(noisy.found);
    sum += (noisy.position - target).norm() / 10;
    EXPECT_GE(noisy.n_inliers, 38);
    EXPECT_LE(noisy.n_inliers, 42);
  }
  EXPECT_LT(sum, test::kTriangulatedNoisyMm);
}

TEST(Keypoints, TriangulationRefusesWhatHasNoPoint) {
  EXPECT_FALSE(triangulate({}).found);
  EXPECT_FALSE(
      triangulate({{Vector3d(0, 0, 0), Vector3d::UnitZ(), 1}, {Vector3d(50, 0, 0), Vector3d::UnitZ(), 1}}).found);
  const auto two = rays_to({0, 1000, 0}, 2, 0, 0);
  EXPECT_FALSE(triangulate(two).found) << "two rays always nearly meet";
}

// A standing person's keypoints in a world that is turned, scaled and shifted.
acquire::SpaceKeypoints standing(double units_per_mm, const Eigen::Matrix3d& turn, const Vector3d& shift) {
  acquire::SpaceKeypoints points;
  const auto set = [&](int k, double x, double y, double z) {
    points[k].found = true;
    points[k].position = turn * (units_per_mm * Vector3d(x, y, z)) + shift;
  };
  set(kLeftHip, 90, 900, 0), set(kRightHip, -90, 900, 0);
  set(kLeftShoulder, 170, 1400, 0), set(kRightShoulder, -170, 1400, 0);
  set(kLeftAnkle, 110, 80, 0), set(kRightAnkle, -110, 80, 0);
  set(kNose, 0, 1560, 110);
  return points;
}

TEST(Keypoints, ComposedFramesAreOneAfterTheOther) {
  acquire::PersonFrame first, then;
  first.scale_mm = 1000, then.scale_mm = 0.9;
  first.rotation = Eigen::AngleAxisd(0.3, Vector3d::UnitX()).toRotationMatrix();
  then.rotation = Eigen::AngleAxisd(-1.1, Vector3d::UnitY()).toRotationMatrix();
  first.translation_mm = {1, -2, 3}, then.translation_mm = {40, 50, -60};
  const Vector3d world(0.2, 1.4, -0.7);
  EXPECT_LT((composed(then, first).to_rest(world) - then.to_rest(first.to_rest(world))).norm(),
            test::kDoubleExact * 1000);
}

TEST(Keypoints, WhoIsNoPersonHasNoFrame) {
  std::vector<std::string> notes;
  const auto refused = [&](const acquire::SpaceKeypoints& world, const char* why) {
    test::expect_refused<ConfigError>([&] { acquire::find_person_frame(world, 0, 1700, notes); }, {why});
  };
  const acquire::SpaceKeypoints person = standing(1, Eigen::Matrix3d::Identity(), {0, 0, 0});
  acquire::SpaceKeypoints world = standing(0, Eigen::Matrix3d::Identity(), {0, 0, 0});
  refused(world, "hips, shoulders and ankles coincide");
  world = person;
  world[kLeftHip] = world[kRightHip], world[kLeftShoulder] = world[kRightShoulder];
  refused(world, "hips, shoulders and ankles coincide");
  world = person;
  std::swap(world[kLeftHip], world[kRightHip]);  // against the shoulders
  refused(world, "hips, shoulders and ankles coincide");
  world = person;
  world[kNose].position.y() = -100;
  refused(world, "the nose is below the ankles");
}

TEST(Keypoints, PersonFrameUndoesTurnScaleAndShift) {
  const Eigen::Matrix3d turn =
      (Eigen::AngleAxisd(1.1, Vector3d::UnitX()) * Eigen::AngleAxisd(0.7, Vector3d::UnitY())).toRotationMatrix();
  for (double unit : {1000.0, 10.0, 1.0, 25.4}) {
    std::vector<std::string> notes;
    const auto world = standing(1 / unit, turn, Vector3d(3, -7, 2));
    const auto frame = acquire::find_person_frame(world, 0, 0, notes);
    EXPECT_NEAR(frame.scale_mm, unit, 1e-9 * unit);
    EXPECT_EQ(notes.size(), 1u);
    const auto rest = acquire::move_keypoints(frame, world);
    EXPECT_LT((rest[kLeftShoulder].position - rest[kLeftHip].position - Vector3d(80, 500, 0)).norm(),
              test::kTriangulatedMm);
    EXPECT_LT((rest[kNose].position - rest[kLeftAnkle].position - Vector3d(-110, 1480, 110)).norm(),
              test::kTriangulatedMm);
  }
  std::vector<std::string> notes;
  EXPECT_THROW(acquire::find_person_frame(standing(0.37, turn, {0, 0, 0}), 0, 0, notes), ConfigError);
  EXPECT_THROW(acquire::find_person_frame(standing(1, turn, {0, 0, 0}), 1000, 0, notes), ConfigError);
  EXPECT_NO_THROW(acquire::find_person_frame(standing(0.37, turn, {0, 0, 0}), 0, 1700, notes));
  EXPECT_THROW(acquire::find_person_frame({}, 0, 0, notes), ConfigError);
  EXPECT_THROW(acquire::unit_in_mm("feet"), ConfigError);
}

TEST(Keypoints, AViewWithAWrongCameraIsFound) {
  const auto world = standing(1, Eigen::Matrix3d::Identity(), {0, 0, 0});
  std::vector<View> views(10);
  std::vector<Detections> detections(views.size());
  for (size_t i = 0; i < views.size(); ++i) {
    const double angle = 2 * M_PI * static_cast<double>(i) / static_cast<double>(views.size());
    View& view = views[i];
    view.camera = camera_from_fov(480, 640, 46);
    view.camera_from_world.linear() =
        Eigen::Vector3d(1, -1, -1).asDiagonal() * Eigen::AngleAxisd(angle, Vector3d::UnitY()).toRotationMatrix();
    view.camera_from_world.translation() = Vector3d(0, 900, 3000);
    detections[i].person = true;
    for (int k = 0; k < kKeypointCount; ++k) {
      Eigen::Vector2d pixel;
      if (!world[k].found || !view.project(world[k].position, pixel)) continue;
      detections[i].keypoints[k].x_px = static_cast<float>(pixel.x());
      detections[i].keypoints[k].y_px = static_cast<float>(pixel.y());
      detections[i].keypoints[k].confidence = 0.9f;
    }
  }
  const std::vector<char> all(views.size(), 1);
  EXPECT_EQ(acquire::agreeing_views(views, detections, acquire::triangulate_keypoints(views, detections)), all);
  views[3].camera_from_world = views[3].camera_from_world * Eigen::AngleAxisd(0.2, Vector3d::UnitX());
  views[7].camera_from_world.translation().x() += 300;
  std::vector<char> expected = all;
  expected[3] = expected[7] = 0;
  EXPECT_EQ(acquire::agreeing_views(views, detections, acquire::triangulate_keypoints(views, detections)), expected);
}

TEST(Keypoints, LevelCamerasTellTheVertical) {
  // A world whose axes mean nothing, the person leaning by 4 degrees, the cameras level but for 1.5 degrees to and fro.
  const Eigen::Matrix3d world_from_room =
      (Eigen::AngleAxisd(0.05, Vector3d::UnitX()) * Eigen::AngleAxisd(0.06, Vector3d::UnitZ())).toRotationMatrix();
  const Eigen::Matrix3d lean = Eigen::AngleAxisd(4 * M_PI / 180, Vector3d::UnitX()).toRotationMatrix();
  std::vector<View> views(24);
  for (size_t i = 0; i < views.size(); ++i) {
    const double angle = 2 * M_PI * static_cast<double>(i) / static_cast<double>(views.size());
    Eigen::Matrix3d camera_from_room;  // looks at the axis, 20 degrees down
    const Vector3d forward = Vector3d(-std::sin(angle), -0.36, -std::cos(angle)).normalized();
    const Vector3d right =
        Eigen::AngleAxisd(0.026 * (i % 2 ? 1 : -1), forward) * forward.cross(Vector3d::UnitY()).normalized();
    camera_from_room << right.transpose(), forward.cross(right).transpose(), forward.transpose();
    views[i].camera_from_world.linear() = camera_from_room * world_from_room.transpose();
  }
  const Vector3d vertical = acquire::vertical_of(views), up = world_from_room.col(1);
  EXPECT_GT(std::abs(vertical.dot(up)), std::cos(test::kVerticalRad));
  std::vector<std::string> notes;
  const auto frame =
      acquire::find_person_frame(standing(1, world_from_room * lean, {0, 0, 0}), 0, 1700, notes, vertical);
  EXPECT_GT(frame.rotation.row(1).dot(up), std::cos(test::kVerticalRad)) << "not an axis of the world";
  // A world that somebody made upright keeps its axis.
  for (View& view : views)
    view.camera_from_world.linear() =
        view.camera_from_world.linear() * world_from_room * Eigen::AngleAxisd(0.01, Vector3d::UnitX());
  EXPECT_EQ(acquire::vertical_of(views).cwiseAbs(), Vector3d(Vector3d::UnitY()));
  // All from one side: no vertical.
  EXPECT_TRUE(acquire::vertical_of({views[0], views[0], views[0]}).isZero());
}

TEST(Keypoints, SymmetryMakesPairsEquallyLong) {
  acquire::BodyJoints joints;
  for (int bone = 0; bone < acquire::kBodyBoneCount; ++bone)
    joints[bone] = Vector3d(std::sin(3.0 * bone), std::cos(5.0 * bone), std::sin(7.0 * bone)) * 300;
  const acquire::BodyJoints before = joints;
  acquire::make_symmetric(joints);
  const auto length = [](const acquire::BodyJoints& j, int bone) {
    return (j[bone] - j[acquire::kBodyBones[bone].parent]).norm();
  };
  for (const auto& [left, right] : {std::pair{acquire::kLeftForeArmBone, acquire::kRightForeArmBone},
                                    std::pair{acquire::kLeftUpLegBone, acquire::kRightUpLegBone},
                                    std::pair{acquire::kLeftFootBone, acquire::kRightFootBone}}) {
    EXPECT_NEAR(length(joints, left), length(joints, right), test::kTriangulatedMm);
    EXPECT_NEAR(length(joints, left), (length(before, left) + length(before, right)) / 2, test::kTriangulatedMm);
  }
}

}  // namespace
}  // namespace livecap
