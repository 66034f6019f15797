#include "render/bone_lines.h"

#include <gtest/gtest.h>

namespace livecap::render {
namespace {

using Eigen::Vector3d;

Skeleton arm() {
  Skeleton skeleton;
  skeleton.bones = {{"root", -1, {}}, {"left_elbow", 0, {}}, {"right_elbow", 0, {}}};
  return skeleton;
}

TEST(BoneLines, FromParentToChildAndOnToTheKeypointsThatThereAre) {
  const std::vector<std::string> names = {"root", "right_elbow", "left_elbow", "left_wrist", "nose"};
  EXPECT_EQ(bone_lines(arm(), names), (std::vector<std::pair<int, int>>{{0, 2}, {0, 1}, {2, 3}}));
}

TEST(BoneLines, WithoutAJointTheBoneAboveIsTheParent) {
  Skeleton skeleton;
  skeleton.bones = {{"root", -1, {}}, {"chest", 0, {}}, {"neck", 1, {}}};
  EXPECT_EQ(bone_lines(skeleton, {"neck", "root"}), (std::vector<std::pair<int, int>>{{1, 0}}));
}

TEST(BoneLines, LeftIsOrangeRightIsBlueAndWhatIsBehindIsLeftOut) {
  const std::vector<std::string> names = {"root", "left_elbow", "right_elbow"};
  const auto lines = bone_lines(arm(), names);
  const Viewpoint view{camera_from_fov(101, 101, 60)};
  ImageRgb canvas{101, 101, std::vector<uint8_t>(3 * 101 * 101, 255)};
  std::vector<Vector3d> joints = {{0, 0, 2000}, {600, 0, 2000}, {-600, 0, 2000}};
  draw_bones(lines, names, joints, view, canvas);
  const uint8_t* left = &canvas.pixels[3 * (50 * 101 + 60)];
  const uint8_t* right = &canvas.pixels[3 * (50 * 101 + 40)];
  EXPECT_GT(left[0], left[2] + 100);
  EXPECT_GT(right[2], right[0] + 100);
  EXPECT_EQ(canvas.pixels[3 * (40 * 101 + 60)], 255);

  ImageRgb empty{101, 101, std::vector<uint8_t>(3 * 101 * 101, 255)};
  for (Vector3d& joint : joints) joint.z() = -2000;
  draw_bones(lines, names, joints, view, empty);
  for (uint8_t value : empty.pixels) ASSERT_EQ(value, 255);
}

}  // namespace
}  // namespace livecap::render
