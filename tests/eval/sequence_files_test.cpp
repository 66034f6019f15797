// Reading truth and capture folders: what is there, what is missing, what is broken.
#include "eval/sequence_files.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

namespace fs = std::filesystem;

class SequenceFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / format("livecap_sequence_files_%d", static_cast<int>(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path file(const std::string& name, const std::string& bytes) const {
    write_file_atomically(folder_ / name, bytes);
    return folder_ / name;
  }

  // The message of the IoError, "" when there is none.
  template <typename Call>
  static std::string refusal(Call&& call) {
    try {
      call();
    } catch (const IoError& error) {
      return error.what();
    }
    return {};
  }

  fs::path folder_;
};

TEST_F(SequenceFiles, JointsJsonWithEmptyFrames) {
  const JointTrack track = read_joints_json(
      file("j.json", R"({"names":["a","b"],"frames":[null,[[1,2,3],[4,5,6]],[null,null],[[null,1,2],[1,2,3]]]})"));
  EXPECT_EQ(track.names, (std::vector<std::string>{"a", "b"}));
  ASSERT_EQ(track.frames.size(), 4u);
  EXPECT_TRUE(track.frames[0].empty());
  EXPECT_EQ(track.frames[1], (std::vector<float>{1, 2, 3, 4, 5, 6}));
  EXPECT_TRUE(track.frames[2].empty());
  EXPECT_TRUE(track.frames[3].empty());
}

TEST_F(SequenceFiles, BrokenJointsJsonNamesTheField) {
  const auto message = [&](const std::string& text) {
    return refusal([&] { read_joints_json(file("j.json", text)); });
  };
  EXPECT_NE(message("not json").find("j.json"), std::string::npos);
  EXPECT_NE(message(R"({"frames":[]})").find("\"names\""), std::string::npos);
  EXPECT_NE(message(R"({"names":["a"],"frames":3})").find("\"frames\""), std::string::npos);
  EXPECT_NE(message(R"({"names":["a"],"frames":[[[1,2,3],[1,2,3]]]})").find("\"frames\"[0]"), std::string::npos);
  EXPECT_NE(message(R"({"names":["a"],"frames":[null,[[1,"2",3]]]})").find("\"frames\"[1]: \"2\" must be a number or"),
            std::string::npos);
  EXPECT_NE(message(R"({"names":["a","b"],"frames":[[null,[1,true,3]]]})").find("true must be"), std::string::npos);
  EXPECT_NE(message(R"({"names":["a"],"frames":[[[1,2]]]})").find("\"frames\"[0]"), std::string::npos);
  EXPECT_NE(message(R"({"names":[7],"frames":[]})").find("\"names\""), std::string::npos);
  EXPECT_NE(refusal([&] { read_joints_json(folder_ / "none.json"); }).find("none.json"), std::string::npos);
}

TEST_F(SequenceFiles, JointsCsv) {
  const JointTrack track = read_joints_csv(
      file("j.csv",
           "index,tracked,joint_root_x,joint_root_y,joint_root_z,keypoint_left_wrist_x,keypoint_left_wrist_y,"
           "keypoint_left_wrist_z\n0,1,1,2,3,4,5,6\n1,0,,,,,,\n"));
  EXPECT_EQ(track.names, (std::vector<std::string>{"root", "left_wrist"}));
  ASSERT_EQ(track.frames.size(), 2u);
  EXPECT_EQ(track.frames[0], (std::vector<float>{1, 2, 3, 4, 5, 6}));
  EXPECT_TRUE(track.frames[1].empty());
}

TEST_F(SequenceFiles, OneUnknownCoordinateMakesItsJointUnknown) {
  const JointTrack track = read_joints_csv(
      file("j.csv",
           "index,pts_ms,tracked,joint_root_x,joint_root_y,joint_root_z,joint_neck_x,joint_neck_y,joint_neck_z\n"
           "4,160,1,1,2,3,4,nan,6\n5,200,0,1,2,3,4,5,6\n6,240,1,,2,3,4,5,inf\n"));
  ASSERT_EQ(track.frames.size(), 3u);
  ASSERT_EQ(track.frames[0].size(), 6u);
  EXPECT_EQ(std::vector<float>(track.frames[0].begin(), track.frames[0].begin() + 3), (std::vector<float>{1, 2, 3}));
  for (int k = 3; k < 6; ++k) EXPECT_TRUE(std::isnan(track.frames[0][k])) << k;
  EXPECT_TRUE(track.frames[2].empty());  // none is known
  ASSERT_EQ(track.rows.size(), 3u);
  EXPECT_EQ(track.rows[0].index, 4);
  EXPECT_EQ(track.rows[1].pts_ms, 200);
  EXPECT_TRUE(track.rows[0].tracked());
  EXPECT_FALSE(track.rows[1].tracked());
  EXPECT_FALSE(track.rows[2].tracked());
  EXPECT_TRUE(read_joints_csv(file("bare.csv", "joint_root_x,joint_root_y,joint_root_z\n1,2,3\n")).rows.empty());
}

TEST_F(SequenceFiles, TextIsNoNumber) {
  const std::string joints = "index,pts_ms,joint_root_x,joint_root_y,joint_root_z\n0,0,1,2,3\n1,40,1,abc,3\n";
  EXPECT_EQ(refusal([&] { read_joints_csv(file("j.csv", joints)); }),
            (folder_ / "j.csv").string() + ": line 3: joint_root_y \"abc\" must be a number, empty or nan");
  EXPECT_NE(refusal([&] { read_angles_csv(file("a.csv", "index,tracked,neck_x\n0,1,30deg\n")); }).find("\"30deg\""),
            std::string::npos);
  EXPECT_NE(refusal([&] { read_frames_csv(file("f.csv", "index,pts_ms,status\n0,soon,ok\n")); }).find("\"soon\""),
            std::string::npos);
}

TEST_F(SequenceFiles, AJointWinsOverTheKeypointOfTheSameName) {
  const JointTrack track = read_joints_csv(
      file("j.csv",
           "index,keypoint_neck_x,keypoint_neck_y,keypoint_neck_z,joint_neck_x,joint_neck_y,joint_neck_z\n"
           "0,1,2,3,4,5,6\n"));
  EXPECT_EQ(track.names, (std::vector<std::string>{"neck"}));
  EXPECT_EQ(track.frames.at(0), (std::vector<float>{4, 5, 6}));
}

// As spreadsheets and people write them.
TEST_F(SequenceFiles, AByteOrderMarkAndBlanksAreNoPartOfACell) {
  const JointTrack track =
      read_joints_csv(file("j.csv",
                           "\xef\xbb\xbf"
                           "index, joint_root_x, joint_root_y, joint_root_z\r\n 4, 1, , -3\r\n5 ,1,2,  3 \r\n"));
  EXPECT_EQ(track.names, std::vector<std::string>{"root"});
  ASSERT_EQ(track.rows.size(), 2u);
  EXPECT_EQ(track.rows[0].index, 4);
  EXPECT_TRUE(track.frames[0].empty());
  EXPECT_EQ(track.frames[1], (std::vector<float>{1, 2, 3}));
}

// Read by place they would be other joints' coordinates, which no figure tells.
TEST_F(SequenceFiles, ColumnsOfAPointStandSideBySide) {
  const auto message = [&](const std::string& columns) {
    return refusal([&] { read_joints_csv(file("j.csv", "index," + columns + "\n0,1,2,3,4,5,6\n")); });
  };
  const std::string path = (folder_ / "j.csv").string();
  EXPECT_EQ(message("joint_neck_x,joint_root_x,joint_neck_y,joint_root_y,joint_neck_z,joint_root_z"),
            path + ": after column \"joint_neck_x\" must come \"joint_neck_y\", not \"joint_root_x\"");
  EXPECT_EQ(message("a,b,c,d,joint_neck_x,joint_neck_y"),
            path + ": after column \"joint_neck_y\" must come \"joint_neck_z\", not the end of the line");
  EXPECT_EQ(message("joint_neck_x,joint_neck_y,joint_neck_z,keypoint_toe_x,joint_toe_y,joint_toe_z"),
            path + ": after column \"keypoint_toe_x\" must come \"keypoint_toe_y\", not \"joint_toe_y\"");
}

TEST_F(SequenceFiles, AnglesCsv) {
  const AngleTrack track =
      read_angles_csv(file("angles.csv", "index,pts_ms,tracked,neck_x,left_elbow_y\n0,0,0,,\n1,40,1,-3.5,90\n"));
  EXPECT_EQ(track.names, (std::vector<std::string>{"neck_x", "left_elbow_y"}));
  ASSERT_EQ(track.frames.size(), 2u);
  EXPECT_TRUE(track.frames[0].empty());
  EXPECT_EQ(track.frames[1], (std::vector<double>{-3.5, 90}));
  EXPECT_NE(refusal([&] { read_angles_csv(file("other.csv", "index,neck_x\n")); }).find("tracked"), std::string::npos);
}

TEST_F(SequenceFiles, FramesCsvHasTimesWhenItHasTheColumns) {
  const std::vector<FrameRow> rows =
      read_frames_csv(file("frames.csv", "index,pts_ms,status,latency_ms\n7,280,ok,99.5\n8,320,lost,3\n"));
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].pts_ms, 280);
  EXPECT_EQ(rows[0].latency_ms, 99.5);
  EXPECT_TRUE(rows[0].tracked());
  EXPECT_FALSE(rows[1].tracked());
  const std::vector<FrameRow> bare = read_frames_csv(file("bare.csv", "index,status\n7,initialized\n"));
  EXPECT_TRUE(std::isnan(bare[0].pts_ms));
  EXPECT_TRUE(bare[0].tracked());
}

TEST_F(SequenceFiles, FramesCsvLeavesOutALineThatWasCutOff) {
  const std::vector<FrameRow> rows = read_frames_csv(file("f.csv", "index,pts_ms,status\n5,0,ok\n6,33.3,lost\n7,66."));
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].index, 5);
  EXPECT_EQ(rows[0].status, "ok");
  EXPECT_EQ(rows[1].status, "lost");
}

TEST_F(SequenceFiles, BrokenCsvNamesColumnOrLine) {
  EXPECT_NE(refusal([&] { read_frames_csv(file("f.csv", "index,pts_ms\n")); }).find("\"status\""), std::string::npos);
  EXPECT_NE(refusal([&] { read_frames_csv(file("f.csv", "index,status\n1,ok\n2\n")); }).find("line 3"),
            std::string::npos);
  // Frames are looked up by it.
  for (const char* index : {"-1", "", "one", "1.5", "9223372036854775808"})
    EXPECT_NE(refusal([&] {
                read_frames_csv(file("f.csv", std::string("index,status\n1,ok\n") + index + ",ok\n"));
              }).find("f.csv: line 3: index \"" + std::string(index) + "\""),
              std::string::npos)
        << index;
  EXPECT_NE(refusal([&] { read_frames_csv(file("f.csv", "")); }).find("empty"), std::string::npos);
  EXPECT_NE(refusal([&] { read_joints_csv(file("j.csv", "index,a\n1,2\n")); }).find("_x"), std::string::npos);
}

}  // namespace
}  // namespace livecap
