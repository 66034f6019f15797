// Movements: limbs bend the way people bend, feet stay on the floor, nothing jerks.
#include "synth/motion.h"

#include <gtest/gtest.h>

#include "livecap/error.h"
#include "support/tolerances.h"
#include "synth/actor_model.h"
#include "synth/synth.h"

namespace livecap::synth {
namespace {

const std::array<Vec3, kBoneCount> joints = BodyShape(Outfit::kSkirt).joints();

Posture upright() {
  return make_motion({"squat"}, 1).front();
}

TEST(Motion, ZeroAnglesHangTheArms) {
  const BonePose pose = pose_of(Posture{}, joints, 1);
  for (int arm : {kLeftArm, kRightArm}) {
    const Vec3 upper = (pose.origins[arm + 1] - pose.origins[arm]).normalized();
    EXPECT_LT(upper.y(), -0.99);
  }
}

TEST(Motion, LimbsBendTheHumanWay) {
  Posture p;
  for (int side : {0, 1}) {
    p.arms[side].elbow = 1.2;
    p.legs[side].flexion = 1.0;
    p.legs[side].knee = 1.3;
  }
  const BonePose pose = pose_of(p, joints, 1);
  for (int shift : {0, kRightShoulder - kLeftShoulder}) {
    const auto at = [&](int bone) { return pose.origins[bone + shift]; };
    EXPECT_GT(at(kLeftHand).z(), at(kLeftForeArm).z() + 150) << "forearms bend to the front";
    EXPECT_GT(at(kLeftLeg).z(), at(kLeftUpLeg).z() + 200) << "thighs lift to the front";
    EXPECT_LT(at(kLeftFoot).z(), at(kLeftLeg).z() - 50) << "shins bend to the back";
  }
}

TEST(Motion, SidesAreMirrored) {
  Posture p = upright();
  p.arms[0].abduction = p.arms[1].abduction = 1.1;
  p.arms[0].flexion = p.arms[1].flexion = 0.4;
  p.legs[0].abduction = p.legs[1].abduction = 0.3;
  const BonePose pose = pose_of(p, joints, 1);
  for (int bone = kLeftShoulder; bone < kRightShoulder; ++bone) {
    const Vec3 left = pose.origins[bone], right = pose.origins[bone + kRightShoulder - kLeftShoulder];
    const Vec3 middle = pose.origins[kHips];
    EXPECT_NEAR(left.x() - middle.x(), middle.x() - right.x(), 12) << kBones[bone].name;  // the posture sways a little
    EXPECT_NEAR(left.y(), right.y(), 1);
  }
  EXPECT_GT(pose.origins[kLeftHand].x(), pose.origins[kLeftArm].x() + 200) << "sideways is away from the body";
}

class Motion : public testing::TestWithParam<std::string> {};

TEST_P(Motion, KeepsFeetOnTheFloorAndIsSmooth) {
  const double fps = 30;
  const auto postures = make_motion({GetParam()}, fps);
  ASSERT_GT(postures.size(), 60u);
  std::vector<BonePose> poses;
  for (const auto& p : postures) poses.push_back(pose_of(p, joints, 1));
  for (size_t i = 0; i < poses.size(); ++i) {
    const double lower = std::min({poses[i].origins[kLeftFoot].y(), poses[i].origins[kRightFoot].y()});
    EXPECT_GT(lower, 20) << "frame " << i;
    EXPECT_LT(lower - postures[i].jump_mm, 230) << "frame " << i << ": ankle height of a standing foot, mm";
    EXPECT_GT(poses[i].origins[kHead].y(), 800);
    if (i == 0) continue;
    for (int bone = 0; bone < kBoneCount; ++bone) {
      const double speed = (poses[i].origins[bone] - poses[i - 1].origins[bone]).norm() * fps / 1000;
      EXPECT_LT(speed, 7) << kBones[bone].name << " m/s in frame " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Motion, testing::ValuesIn(motion_names()), [](const auto& info) { return info.param; });

TEST(Motion, CrouchBendsKneesAboveFlatFeet) {
  const auto straight = make_motion({"raise"}, 30), bent = make_motion({"raise"}, 30, 0.25);
  ASSERT_EQ(straight.size(), bent.size());
  for (size_t i = 0; i < bent.size(); i += 9) {
    const BonePose from = pose_of(straight[i], joints, 1), pose = pose_of(bent[i], joints, 1);
    for (int shift : {0, kRightShoulder - kLeftShoulder}) {
      const auto knee_before_hip = [&](const BonePose& p) {
        return (p.origins[kLeftLeg + shift] - p.origins[kLeftUpLeg + shift]).z();
      };
      EXPECT_NEAR(knee_before_hip(pose) - knee_before_hip(from), 100, 20) << "frame " << i << ", mm";
      EXPECT_LT((pose.origins[kHips] - pose.origins[kLeftFoot + shift]).z(), 40) << "hips stay above the feet";
      EXPECT_LT(pose.rotations[kLeftFoot + shift].angularDistance(from.rotations[kLeftFoot + shift]), 0.05)
          << "feet stay flat, but for what a leg that is turned outwards gives them";
    }
    EXPECT_LT(pose.origins[kHips].y(), from.origins[kHips].y() - 15);
  }
}

TEST(Motion, TurnGoesAllTheWayRoundAndStays) {
  const auto postures = make_motion({"turn", "raise"}, 30);
  double smallest = 1, largest = 0;
  for (const auto& p : postures) smallest = std::min(smallest, p.yaw), largest = std::max(largest, p.yaw);
  EXPECT_NEAR(largest - smallest, 2 * M_PI, 0.1);
  EXPECT_NEAR(postures.back().yaw, 2 * M_PI, 0.1) << "the next motion does not turn back";
}

TEST(Motion, TurntableTurnsTheStillBodyMoreThanOnce) {
  const auto postures = make_motion({"turntable"}, 30);
  EXPECT_NEAR(postures.back().yaw, 2 * M_PI * 1.05, 0.01);
  for (size_t i = 1; i < postures.size(); ++i) EXPECT_GE(postures[i].yaw, postures[i - 1].yaw);
  // While it turns nothing else moves but breath and sway.
  const Posture& first = postures[20];
  for (const auto& p : postures) {
    if (p.yaw <= 0 || p.yaw >= postures.back().yaw) continue;
    for (int side = 0; side < 2; ++side) {
      EXPECT_DOUBLE_EQ(p.arms[side].abduction, first.arms[side].abduction);
      EXPECT_DOUBLE_EQ(p.legs[side].flexion, first.legs[side].flexion);
    }
  }
}

TEST(Motion, UnknownNameIsRefused) {
  EXPECT_THROW(make_motion({"moonwalk"}, 30), ConfigError);
}

TEST(Motion, SkinningFollowsTheBones) {
  // One bone: a rigid motion. Two equal bones: the half-way rotation about the common axis.
  Posture p;
  p.legs[0].knee = 1.4;
  const BonePose pose = pose_of(p, joints, 1);
  const Vec3 point = joints[kLeftLeg] + Vec3(12, -90, 33);
  std::vector<Influences> weights(2);
  weights[0][0] = {kLeftLeg, 1};
  weights[1][0] = {kLeftLeg, 0.5};
  weights[1][1] = {kLeftUpLeg, 0.5};
  const auto posed = skin_vertices({point, point}, weights, joints, pose);
  const Vec3 from_knee = point - joints[kLeftLeg];
  const Eigen::Matrix3d thigh = pose.rotations[kLeftUpLeg].toRotationMatrix();
  const Eigen::Matrix3d whole = thigh * Eigen::AngleAxisd(1.4, Vec3::UnitX()).toRotationMatrix();
  const Eigen::Matrix3d halfway = thigh * Eigen::AngleAxisd(0.7, Vec3::UnitX()).toRotationMatrix();
  EXPECT_LT((posed[0] - pose.origins[kLeftLeg] - whole * from_knee).norm(), test::kDoubleExact * 1000);
  EXPECT_LT((posed[1] - pose.origins[kLeftLeg] - halfway * from_knee).norm(), test::kDoubleExact * 1000);
}

}  // namespace
}  // namespace livecap::synth
