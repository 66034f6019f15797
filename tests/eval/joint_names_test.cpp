#include "eval/joint_names.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace livecap {
namespace {

const std::vector<std::string> kCaptured = {"root",        "neck",           "left_clavicle", "left_shoulder",
                                            "left_elbow",  "right_shoulder", "right_elbow",   "left_hip",
                                            "left_knee",   "left_ankle",     "right_hip",     "right_knee",
                                            "right_ankle", "left_wrist",     "right_wrist"};

const JointPair* find(const std::vector<JointPair>& pairs, const std::string& name) {
  const auto found = std::find_if(pairs.begin(), pairs.end(), [&](const JointPair& pair) { return pair.name == name; });
  return found == pairs.end() ? nullptr : &*found;
}

TEST(JointNames, MixamoUpperArmIsTheShoulderAndMixamoShoulderIsNot) {
  const std::vector<JointPair> pairs = match_joints(kCaptured, {"LeftShoulder", "LeftArm", "LeftForeArm", "LeftHand"});
  ASSERT_EQ(pairs.size(), 3u);
  ASSERT_NE(find(pairs, "left_shoulder"), nullptr);
  EXPECT_EQ(find(pairs, "left_shoulder")->truth, 1);
  EXPECT_EQ(find(pairs, "left_shoulder")->captured, 3);
  EXPECT_EQ(find(pairs, "left_elbow")->truth, 2);
  EXPECT_EQ(find(pairs, "left_wrist")->truth, 3);
}

TEST(JointNames, PrefixesDoNotMatter) {
  const std::vector<JointPair> pairs = match_joints(kCaptured, {"mixamorig:RightLeg", "mixamorig:Hips"});
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(find(pairs, "right_knee")->truth, 0);
  EXPECT_EQ(find(pairs, "root")->truth, 1);
}

TEST(JointNames, UnrealNames) {
  const std::vector<JointPair> pairs = match_joints(kCaptured, {"pelvis", "thigh_l", "calf_r", "hand_r"});
  ASSERT_EQ(pairs.size(), 4u);
  EXPECT_EQ(find(pairs, "left_hip")->truth, 1);
  EXPECT_EQ(find(pairs, "right_knee")->truth, 2);
  EXPECT_EQ(find(pairs, "right_wrist")->truth, 3);
}

TEST(JointNames, OwnNamesMatchThemselves) {
  std::vector<std::string> shuffled(kCaptured.rbegin(), kCaptured.rend());
  const std::vector<JointPair> pairs = match_joints(kCaptured, shuffled);
  EXPECT_EQ(pairs.size(), 14u);  // all but the clavicle
  for (const JointPair& pair : pairs) {
    EXPECT_EQ(kCaptured[pair.captured], pair.name);
    EXPECT_EQ(shuffled[pair.truth], pair.name);
  }
}

TEST(JointNames, TheCapturedRootMayBeThePelvis) {
  const std::vector<JointPair> pairs = match_joints({"neck", "pelvis"}, {"mixamorig:Hips"});
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].name, "root");
  EXPECT_EQ(pairs[0].captured, 1);
  EXPECT_EQ(match_joints({"pelvis", "root"}, {"Hips"}).at(0).captured, 1);
}

TEST(JointNames, NamesWhatOnlyTheTruthHas) {
  EXPECT_EQ(joints_not_captured({"left_knee"}, {"Hips", "LeftLeg", "RightHand", "Tail"}),
            (std::vector<std::string>{"root", "right_wrist"}));
}

TEST(JointNames, NothingInCommonGivesNothing) {
  EXPECT_TRUE(match_joints(kCaptured, {"Bone.001"}).empty());
}

}  // namespace
}  // namespace livecap
