#include "actor/skeletool.h"

#include <gtest/gtest.h>

#include "base/text.h"
#include "livecap/error.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

std::filesystem::path write(const char* name, const std::string& text) {
  const auto path = std::filesystem::path(testing::TempDir()) / name;
  write_file_atomically(path, text);
  return path;
}

const char* const kSkeleton = R"(Skeletool Skeleton Definition V1.0
joints: 11
  root_tx   prismatic none      0 0 0   1 0 0  1
  root_ty   prismatic root_tx   0 0 0   0 1 0  1
  root_tz   prismatic root_ty   0 0 0   0 0 1  1
  root_rx   revolute  root_tz   0 0 0   1 0 0  1
  root_ry   revolute  root_rx   0 0 0   0 1 0  1
  spine_rx  revolute  root_ry   0 100 0 1 0 0  1
  spine_ry  revolute  spine_rx  0 0 0   0 1 0  1
  chest_rx  revolute  spine_ry  0 200 0 1 0 0  1
  arm_rz    revolute  chest_rx  90 50 0 0 0 2  2

  leg_rx    revolute  root_ry   80 -40 0 1 0 0 1
  foot_rx   revolute  leg_rx    0 -400 0 1 0 0 1
markers: 2
  hand  arm_rz  point 250 0 0
  toe   foot    point 0 -50 120 10 1 0 0
scaling joints: 1
  legs 1
    leg_rx
dofs: 8
  tx 1
    nolimits
    root_tx 1
  ty 1
    nolimits
    root_ty 1
  rx 1
    nolimits
    root_rx 1
  bend 2
    limits -1 2
    spine_rx 0.5
    chest_rx 0.5
  twist 1
    limits -0.5 0.5
    spine_ry 1
  arm 1
    limits -1.5 1.5
    arm_rz -1
  leg 1
    nolimits
    leg_rx 1
  foot 1
    limits -0.3 0.8
    foot_rx 1
)";

TEST(Skeletool, SkeletonBecomesTheSameChain) {
  const SkeletoolSkeleton s = load_skeletool_skeleton(write("a.skeleton", kSkeleton));
  ASSERT_EQ(s.skeleton.n_bones(), 6);  // root, spine, chest, arm, leg, foot
  EXPECT_EQ(s.skeleton.n_dofs(), 6);
  EXPECT_EQ(s.n_parameters(), 8);
  EXPECT_EQ(s.skeleton.bones[1].name, "spine");
  EXPECT_EQ(s.notes.size(), 1u);  // bend turns two joints
  const Dof& arm = s.skeleton.dofs[3];
  EXPECT_EQ(arm.name, "arm_rz");
  EXPECT_NEAR(arm.min_rad, -1.5, test::kDoubleExact);

  // The file's chain multiplied out by hand, one single-axis matrix per line of the file.
  Eigen::VectorXd p(8);
  p << 10, 20, 0.3, 0.8, -0.2, 0.7, -0.4, 0.5;
  using Eigen::AngleAxisd, Eigen::Isometry3d, Eigen::Translation3d, Eigen::Vector3d;
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  const Isometry3d root = Translation3d(10, 20, 0) * Isometry3d(AngleAxisd(0.3, x));
  const Isometry3d spine = root * Translation3d(0, 100, 0) * AngleAxisd(0.4, x) * AngleAxisd(-0.2, y);
  const Isometry3d chest = spine * Translation3d(0, 200, 0) * AngleAxisd(0.4, x);
  const Isometry3d arm_frame = chest * Translation3d(180, 100, 0) * AngleAxisd(-0.7, z);  // scale 2
  const Isometry3d foot =
      root * Translation3d(80, -40, 0) * AngleAxisd(-0.4, x) * Translation3d(0, -400, 0) * AngleAxisd(0.5, x);
  const PosedSkeleton posed = forward_kinematics(s.skeleton, s.pose(p));
  EXPECT_LT((posed.camera_from_bone[0].matrix() - root.matrix()).norm(), test::kDoubleExact);
  EXPECT_LT((posed.camera_from_bone[s.skeleton.bone_index("arm")].matrix() - arm_frame.matrix()).norm(),
            test::kDoubleExact);
  EXPECT_LT((posed.camera_from_bone[s.skeleton.bone_index("foot")].matrix() - foot.matrix()).norm(),
            test::kDoubleExact);
  EXPECT_EQ(s.skeleton.bones[s.markers[1].bone].name, "foot");
  const SkeletoolMarker& hand = s.markers[0];
  EXPECT_LT((posed.camera_from_rest[hand.bone] * hand.rest_position_mm - arm_frame * Vector3d(250, 0, 0)).norm(),
            test::kDoubleExact);
}

// A forearm's twist at the elbow's place turns what is bound to it, and not what is bound to the elbow.
TEST(Skeletool, JointsOfOtherNamesAreOtherBones) {
  std::string text = kSkeleton;
  text.replace(text.find("spine_ry  revolute"), 8, "twist_ry");
  for (size_t at; (at = text.find("spine_ry")) != std::string::npos;) text.replace(at, 8, "twist_ry");
  const SkeletoolSkeleton s = load_skeletool_skeleton(write("t.skeleton", text));
  ASSERT_EQ(s.skeleton.n_bones(), 7);
  Eigen::VectorXd p = Eigen::VectorXd::Zero(8);
  p[4] = 0.5;  // the twist
  const PosedSkeleton posed = forward_kinematics(s.skeleton, s.pose(p));
  EXPECT_LT((posed.camera_from_bone[s.skeleton.bone_index("spine")].linear() - Eigen::Matrix3d::Identity()).norm(),
            test::kDoubleExact);
  const Eigen::Matrix3d turned = Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitY()).toRotationMatrix();
  EXPECT_LT((posed.camera_from_bone[s.skeleton.bone_index("twist")].linear() - turned).norm(), test::kDoubleExact);
  EXPECT_EQ(s.scaled_joint, "arm_rz");
}

TEST(Skeletool, SkinWeightsMeanTheLastJointOfABone) {
  const SkeletoolSkeleton s = load_skeletool_skeleton(write("b.skeleton", kSkeleton));
  std::vector<std::string> notes;
  const SkinWeights skin = load_skeletool_skin(write("b.skin", R"(Skeletool character skinning file V1.0
bones:
  root spine chest arm leg foot
vertex weights:
    0   1 0.25 3 0.75
    1   0 0.1 1 0.1 2 0.3 3 0.4 5 0.1
    2   4 2.0
)"),
                                               s, notes);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("up to 10 %"), std::string::npos);
  ASSERT_EQ(skin.bones.size(), 12u);
  EXPECT_EQ(skin.bones[0], s.skeleton.bone_index("arm"));
  EXPECT_FLOAT_EQ(skin.weights[0], 0.75f);
  EXPECT_EQ(skin.bones[4], s.skeleton.bone_index("arm"));
  EXPECT_FLOAT_EQ(skin.weights[4] + skin.weights[5] + skin.weights[6] + skin.weights[7], 1.f);
  EXPECT_FLOAT_EQ(skin.weights[4], 0.4f / 0.9f);
  EXPECT_EQ(skin.bones[8], s.skeleton.bone_index("leg"));
  EXPECT_FLOAT_EQ(skin.weights[8], 1.f);
}

TEST(Skeletool, MotionAndCameras) {
  const SkeletoolMotion motion =
      load_skeletool_motion(write("c.motion", "Skeletool Motion File V1.0\r\n 3 1 2.5 -3e-1\r\n 4 0 0 0\n"), 3);
  ASSERT_EQ(motion.frames.size(), 2u);
  EXPECT_EQ(motion.frames[0], 3);
  EXPECT_NEAR(motion.parameters[0][2], -0.3, test::kDoubleExact);

  const auto cameras = load_skeletool_cameras(write("d.calibration", R"(Skeletool Camera Calibration File V1.0
name          0
  sensor      10 10
  size        2048 1024
  animated    0
  intrinsic   1497.5 0 1024.7 0 0 1497.25 523.5 0 0 0 1 0 0 0 0 1
  extrinsic   0 -1 0 100 1 0 0 -200 0 0 1 3000 0 0 0 1
  radial      0
name          left
  sensor      10 10
  size        640 480
  animated    0
  intrinsic   500 0 320 0 0 501 240 0 0 0 1 0 0 0 0 1
  extrinsic   1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1
  radial      0
)"));
  ASSERT_EQ(cameras.size(), 2u);
  EXPECT_EQ(cameras[0].camera.width, 2048);
  EXPECT_EQ(cameras[0].camera.fy, 1497.25);
  EXPECT_EQ(cameras[0].camera.cy, 523.5);
  EXPECT_LT((cameras[0].camera_from_world * Eigen::Vector3d(1, 2, 3) - Eigen::Vector3d(98, -199, 3003)).norm(),
            test::kDoubleExact);
  EXPECT_EQ(cameras[1].name, "left");
}

TEST(Skeletool, BrokenFilesNameTheLine) {
  auto message = [](const std::string& text) {
    try {
      load_skeletool_skeleton(write("broken.skeleton", text));
    } catch (const IoError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  auto edited = [&](const std::string& from, const std::string& to) {
    std::string text = kSkeleton;
    text.replace(text.find(from), from.size(), to);
    return message(text);
  };
  EXPECT_NE(message("something else").find("does not begin with"), std::string::npos);
  EXPECT_NE(edited("spine_rx  revolute", "spine_rx  spherical").find("broken.skeleton:8: joint type"),
            std::string::npos);
  EXPECT_NE(edited("spine_rx  revolute", "spine_rx  prismatic").find("only the root may slide"), std::string::npos);
  EXPECT_NE(edited("joints: 11", "joints: 12").find("a joint needs"), std::string::npos);
  EXPECT_NE(edited("joints: 11", "joints: 999999999").find("999999999 joints, at most"), std::string::npos);
  EXPECT_NE(edited("90 50 0 0 0 2  2", "90 1e300 0 0 0 2  1e30").find(":11: \"1e300\" must be a number within"),
            std::string::npos);
  EXPECT_NE(edited("0 100 0 1 0 0  1", "0 100 0 1e200 1e200 0  1").find("must be a number within"), std::string::npos);
  EXPECT_NE(edited("arm_rz -1", "arm_xx -1").find("no joint \"arm_xx\""), std::string::npos);
  EXPECT_NE(edited("limits -1 2", "limits 2 -1").find("reversed"), std::string::npos);
  EXPECT_NE(edited("0 200 0 1 0 0  1", "0 nan 0 1 0 0  1").find("must be a number"), std::string::npos);
  const std::string whole = kSkeleton;
  for (size_t size = 0; size + 20 < whole.size(); size += 13) EXPECT_NE(message(whole.substr(0, size)), "") << size;
  EXPECT_NE(edited("chest_rx  revolute  spine_ry", "spine_ry  revolute  spine_ry").find(":10: a second joint"),
            std::string::npos);
  for (const char* frames : {"0 1 2\n", "", "1 1 2 3\n1 1 2 3\n", "0 1 2 inf\n"})
    EXPECT_THROW(load_skeletool_motion(write("e.motion", std::string("Skeletool Motion File V1.0\n") + frames), 3),
                 IoError);
  EXPECT_THROW(
      load_skeletool_cameras(write("e.calibration", "Skeletool Camera Calibration File V1.0\nname 0\n size 10 10\n")),
      IoError);
}

}  // namespace
}  // namespace livecap
