#include "acquire/body_rig.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include "base/text.h"
#include "livecap/error.h"
#include "support/tolerances.h"

namespace livecap::acquire {
namespace {

using Eigen::Vector3d;

TEST(BodyRig, GivenFaceMarkersReplaceSeenOnes) {
  const auto path = std::filesystem::temp_directory_path() / ("livecap_joints_" + std::to_string(::getpid()) + ".json");
  write_file_atomically(path, R"({"unit": "cm", "joints": {"nose": [1, 150, 12], "left_elbow": [30, 120, 0]}})");
  const GivenJoints given = read_joints(path);
  SpaceKeypoints seen;
  for (int k : {kNose, kChin}) seen[k].found = true, seen[k].position = Vector3d(5, 1400 + k, 90);
  PersonFrame frame;  // a world in metres
  frame.scale_mm = 1000;
  const auto markers = face_markers(seen, given, frame);
  ASSERT_EQ(markers.size(), 2u);  // nobody knows the eyes
  EXPECT_LT((markers.at("nose") - Vector3d(10, 1500, 120)).norm(), test::kDoubleExact);
  EXPECT_LT((markers.at("chin") - seen[kChin].position).norm(), test::kDoubleExact);
  BodyJoints joints;
  joints.fill(Vector3d::Zero());
  override_joints(given, frame, joints);
  EXPECT_LT((joints[kLeftForeArmBone] - Vector3d(300, 1200, 0)).norm(), test::kDoubleExact);

  write_file_atomically(path, R"({"left_ear": [1, 2, 3]})");
  EXPECT_THROW(read_joints(path), IoError);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace livecap::acquire
