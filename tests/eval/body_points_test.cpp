// Joints as points of the body: what a displaced skeleton must not change, and what it must.
#include "eval/body_points.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "eval/metrics.h"
#include "support/tolerances.h"
#include "synth/synth.h"

namespace livecap {
namespace {

constexpr double kElbowMm = 20, kKneeMm = 30, kWristMm = 15;

class BodyPoints : public testing::Test {
 protected:
  // The truth, and the same body with its left elbow, right knee and right wrist elsewhere; nothing below them moves.
  static void SetUpTestSuite() {
    truth_ = load_actor_bytes(make_builtin_actor_glb("trousers", kBuiltinHeightMm, 1500), "trousers");
    built_ = truth_;
    auto& bones = built_.skeleton.bones;
    bones[built_.skeleton.bone_index("left_elbow")].offset_mm.x() += kElbowMm;
    const int knee = built_.skeleton.bone_index("right_knee");
    const Eigen::Vector3d down(0, -kKneeMm, 0);
    bones[knee].offset_mm += down;
    double bent = 0;  // the knee's angle at rest, about x
    for (const Dof& dof : built_.skeleton.dofs) bent += dof.bone == knee ? dof.rest_rad : 0;
    bones[built_.skeleton.bone_index("right_ankle")].offset_mm -=
        Eigen::AngleAxisd(-bent, Eigen::Vector3d::UnitX()) * down;
    built_.keypoints[kRightWrist].rest_position_mm.z() += kWristMm;
  }

  static std::vector<std::string> joint_names() {
    std::vector<std::string> names;
    for (const Bone& bone : truth_.skeleton.bones) names.push_back(bone.name);
    for (int k : {kLeftWrist, kRightWrist}) names.emplace_back(kKeypointNames[k]);
    return names;
  }

  static std::vector<float> joints_of(const Actor& actor, const Pose& pose) {
    const PosedSkeleton posed = forward_kinematics(actor.skeleton, pose);
    std::vector<float> joints;
    const auto add = [&](const Eigen::Vector3d& p) {
      for (int k = 0; k < 3; ++k) joints.push_back(static_cast<float>(p[k]));
    };
    for (const Eigen::Isometry3d& bone : posed.camera_from_bone) add(bone.translation());
    for (int k : {kLeftWrist, kRightWrist})
      add(posed.camera_from_rest[actor.keypoints[k].bone] * actor.keypoints[k].rest_position_mm);
    return joints;
  }

  // Distances of captured joints, and of the same points of the body, to the true ones in a pose of both skeletons.
  static std::pair<std::map<std::string, double>, std::map<std::string, double>> distances(const Actor& actor,
                                                                                           const Pose& pose) {
    CaptureFolder capture;
    capture.actor = actor;
    capture.joints.names = joint_names();
    for (const Dof& dof : actor.skeleton.dofs) capture.angles.names.push_back(dof.name);
    std::vector<double> angles_deg;
    for (double angle : pose.angles_rad) angles_deg.push_back(angle * 180 / std::numbers::pi);
    capture.angles.frames = {angles_deg};
    const std::vector<JointPair> pairs = match_joints(joint_names(), joint_names());
    EXPECT_EQ(pairs.size(), 14u);
    const CarriedJoints points(actor, truth_, overlay_rest(actor, truth_), pairs);
    const std::vector<float> joints = joints_of(actor, pose), expected = joints_of(truth_, pose);
    const std::vector<double> by_name = point_distances(joints, expected),
                              same = point_distances(points.at(joints, captured_bones(capture, 0, joints)), expected);
    std::pair<std::map<std::string, double>, std::map<std::string, double>> result;
    for (const JointPair& pair : pairs) {
      result.first[pair.name] = by_name[pair.captured];
      result.second[pair.name] = same[pair.captured];
    }
    return result;
  }

  // Turned and moved, arms and legs swung from shoulder and hip.
  static Pose swung() {
    Pose pose = rest_pose(truth_.skeleton);
    pose.root_rotation = Eigen::AngleAxisd(2.5, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
    pose.root_translation_mm = {200, -100, 3100};
    for (int k = 0; k < truth_.skeleton.n_dofs(); ++k) {
      const std::string& name = truth_.skeleton.dofs[k].name;
      if (name.find("shoulder") != std::string::npos) pose.angles_rad[k] += 0.4;
      if (name.find("hip") != std::string::npos) pose.angles_rad[k] -= 0.3;
    }
    return pose;
  }

  static inline Actor truth_, built_;
};

TEST_F(BodyPoints, ADisplacedSkeletonThatMovesRightIsRight) {
  const auto [by_name, same] = distances(built_, swung());
  const std::map<std::string, double> displaced = {
      {"left_elbow", kElbowMm}, {"right_knee", kKneeMm}, {"right_wrist", kWristMm}};
  for (const auto& [name, mm] : by_name) {
    EXPECT_NEAR(mm, displaced.count(name) ? displaced.at(name) : 0, test::kMillimetreFloat) << name;
  }
  for (const auto& [name, mm] : same) EXPECT_LT(mm, test::kMillimetreFloat) << name;
}

TEST_F(BodyPoints, TheTruthsOwnSkeletonHasItsOwnJoints) {
  const auto [by_name, same] = distances(truth_, swung());
  for (const auto& [name, mm] : same) EXPECT_LT(mm, test::kMillimetreFloat) << name;
  for (const auto& [name, mm] : by_name) EXPECT_EQ(mm, 0) << name;
}

// A bone that turned wrongly takes its points along: the true wrist 0.1 rad about an elbow that is in its place.
TEST_F(BodyPoints, ABoneThatTurnedWronglyIsSeen) {
  const Pose pose = swung();
  const PosedSkeleton posed = forward_kinematics(truth_.skeleton, pose);
  const int elbow = truth_.skeleton.bone_index("right_elbow");
  const CarriedJoints points(built_, truth_, overlay_rest(built_, truth_), {{"right_wrist", 1, 0}});
  std::vector<Eigen::Isometry3d> bones = posed.camera_from_rest;
  const Eigen::Vector3d centre = posed.camera_from_bone[elbow].translation();
  const Eigen::Vector3d wrist = bones[elbow] * truth_.keypoints[kRightWrist].rest_position_mm;
  const Eigen::Vector3d axis = (wrist - centre).unitOrthogonal();
  bones[elbow] =
      Eigen::Translation3d(centre) * Eigen::AngleAxisd(0.1, axis) * Eigen::Translation3d(-centre) * bones[elbow];
  const std::vector<float> moved = points.at({1, 2, 3, 4, 5, 6}, bones);
  const Eigen::Vector3d at = Eigen::Map<const Eigen::Vector3f>(&moved[3]).cast<double>();
  EXPECT_NEAR((at - wrist).norm(), 2 * std::sin(0.05) * (wrist - centre).norm(), test::kMillimetreFloat);
  EXPECT_EQ(moved[0], 1);  // not of a pair
}

TEST_F(BodyPoints, NothingIsKnownWithoutAnglesOrJoints) {
  CaptureFolder capture;
  capture.actor = truth_;
  capture.joints.names = joint_names();
  const std::vector<float> joints = joints_of(truth_, swung());
  EXPECT_TRUE(captured_bones(capture, 0, joints).empty());  // no angles.csv
  for (const Dof& dof : truth_.skeleton.dofs) capture.angles.names.push_back(dof.name);
  capture.angles.frames = {{}, std::vector<double>(capture.angles.names.size())};
  EXPECT_TRUE(captured_bones(capture, 0, joints).empty());  // a row without result
  EXPECT_FALSE(captured_bones(capture, 1, joints).empty());
  EXPECT_TRUE(captured_bones(capture, 1, {}).empty());
  EXPECT_TRUE(captured_bones(capture, 2, joints).empty());
  std::vector<float> partly = joints;
  partly[3] = NAN;  // of a bone
  EXPECT_TRUE(captured_bones(capture, 1, partly).empty());
  for (std::string& name : capture.angles.names)
    if (name == "left_ankle_z") name = "tail_z";
  EXPECT_FALSE(captured_bones(capture, 1, joints).empty());  // of before feet tilted
  capture.angles.names[3] = "tail_x";
  EXPECT_TRUE(captured_bones(capture, 1, joints).empty());
}

}  // namespace
}  // namespace livecap
