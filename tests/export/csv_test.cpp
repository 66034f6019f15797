#include "export/csv.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "base/text.h"
#include "export/motion_fixture.h"
#include "livecap/error.h"
#include "support/comma_locale.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

std::vector<std::vector<std::string>> table(const std::filesystem::path& path) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream in(read_file(path));
  for (std::string line; std::getline(in, line);) {
    rows.emplace_back();
    std::istringstream cells(line + ",");
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

TEST(Csv, FramesHaveOneRowEachAtOnce) {
  const auto path = std::filesystem::path(testing::TempDir()) / "frames.csv";
  const std::vector<std::string> stages = {"read", "network", "segment", "pose", "surface", "output"};
  FramesCsvWriter writer(path, stages);
  FrameReport report;
  report.index = 12;
  report.pts_ms = 400.25;
  report.iou = NAN;
  report.stage_ms[3] = 7.5;
  writer.append(report, "nobody");
  const auto rows = table(path);
  ASSERT_EQ(rows.size(), 2u);
  ASSERT_EQ(rows[0].size(), rows[1].size());
  auto cell = [&](const std::string& name) {
    return rows[1][std::find(rows[0].begin(), rows[0].end(), name) - rows[0].begin()];
  };
  EXPECT_EQ(cell("index"), "12");
  EXPECT_EQ(cell("pts_ms"), "400.25");
  EXPECT_EQ(cell("status"), "nobody");
  EXPECT_EQ(cell("iou"), "");
  EXPECT_EQ(cell("pose_ms"), "7.5");
  EXPECT_THROW(FramesCsvWriter(path, {"one"}), LogicError);
  EXPECT_THROW(CsvWriter("/nonexistent/x.csv", {"a"}), IoError);
}

TEST(Csv, NumbersHaveAPointInEveryLocale) {
  LIVECAP_COMMA_LOCALE_OR_SKIP(commas);
  EXPECT_EQ(csv_number(1234.5), "1234.5");
  EXPECT_EQ(csv_number(2.0 / 3, 5), "0.66667");
}

TEST(Csv, JointsAreMetresInTheGltfFrame) {
  const Actor actor = test::small_actor();
  const Pose pose = test::smooth_motion(actor.skeleton, 5)[4];
  const auto path = std::filesystem::path(testing::TempDir()) / "joints.csv";
  JointsCsvWriter writer(path, actor);
  writer.append_missing(0, 0);
  writer.append(1, 33.3, true, pose);
  const auto rows = table(path);
  ASSERT_EQ(rows.size(), 3u);
  ASSERT_EQ(rows[0].size(), rows[1].size());
  ASSERT_EQ(rows[0].size(), rows[2].size());
  EXPECT_EQ(rows[1][5], "");
  auto value = [&](const std::string& name) {
    return std::stod(rows[2][std::find(rows[0].begin(), rows[0].end(), name) - rows[0].begin()]);
  };
  const PosedSkeleton posed = forward_kinematics(actor.skeleton, pose);
  const Eigen::Vector3d knee = posed.camera_from_bone[actor.skeleton.bone_index("left_knee")].translation();
  EXPECT_NEAR(value("joint_left_knee_x"), knee.x() / 1000, test::kCsvMetres);
  EXPECT_NEAR(value("joint_left_knee_y"), -knee.y() / 1000, test::kCsvMetres);
  EXPECT_NEAR(value("joint_left_knee_z"), -knee.z() / 1000, test::kCsvMetres);
  EXPECT_NEAR(value("keypoint_left_knee_y"), -knee.y() / 1000, test::kCsvMetres);
}

TEST(Csv, AnglesAreInDegreesUnderTheirNames) {
  const Actor actor = test::small_actor();
  Pose pose = test::smooth_motion(actor.skeleton, 5)[4];
  const auto path = std::filesystem::path(testing::TempDir()) / "angles.csv";
  AnglesCsvWriter writer(path, actor.skeleton);
  writer.append_missing(0, 0);
  pose.angles_rad[2] = 0.5235987755982988;  // 30 degrees
  writer.append(1, 40, false, pose);
  const auto rows = table(path);
  ASSERT_EQ(rows.size(), 3u);
  ASSERT_EQ(rows[0].size(), 3u + actor.skeleton.n_dofs());
  EXPECT_EQ(rows[0][5], actor.skeleton.dofs[2].name);
  EXPECT_EQ(rows[1][5], "");
  EXPECT_EQ(rows[2][2], "0");
  EXPECT_EQ(rows[2][5], "30");
}

}  // namespace
}  // namespace livecap
