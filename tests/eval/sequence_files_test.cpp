// Reading truth and capture folders: what is there, what is missing, what is broken.
#include "eval/sequence_files.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>

#include "base/text.h"
#include "eval/pc2_file.h"
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

// 12 bytes magic, version, points, start, rate, samples, data.
std::string pc2_bytes(int32_t version, int32_t points, int32_t samples, const std::vector<float>& data) {
  std::string bytes("POINTCACHE2\0", 12);
  const auto append = [&](const auto& value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof(value)); };
  append(version);
  append(points);
  append(0.0f);
  append(1.0f);
  append(samples);
  for (float value : data) append(value);
  return bytes;
}

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
  EXPECT_NE(message(R"({"names":["a"],"frames":[[[1,2]]]})").find("\"frames\"[0]"), std::string::npos);
  EXPECT_NE(message(R"({"names":[7],"frames":[]})").find("\"names\""), std::string::npos);
  EXPECT_NE(refusal([&] { read_joints_json(folder_ / "none.json"); }).find("none.json"), std::string::npos);
}

TEST_F(SequenceFiles, JointsCsv) {
  const JointTrack track = read_joints_csv(
      file("j.csv", "index,root_x,root_y,root_z,left_knee_x,left_knee_y,left_knee_z\n0,1,2,3,4,5,6\n1,,,,,,\n"));
  EXPECT_EQ(track.names, (std::vector<std::string>{"root", "left_knee"}));
  ASSERT_EQ(track.frames.size(), 2u);
  EXPECT_EQ(track.frames[0], (std::vector<float>{1, 2, 3, 4, 5, 6}));
  EXPECT_TRUE(track.frames[1].empty());
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
  EXPECT_NE(refusal([&] { read_frames_csv(file("f.csv", "")); }).find("empty"), std::string::npos);
  EXPECT_NE(refusal([&] { read_joints_csv(file("j.csv", "index,a\n1,2\n")); }).find("_x"), std::string::npos);
}

TEST_F(SequenceFiles, Pc2SamplesAndAWriterThatWasStopped) {
  std::vector<float> data(2 * 6 + 4);  // two whole samples of two points and a part of the third
  for (size_t i = 0; i < data.size(); ++i) data[i] = static_cast<float>(i);
  Pc2File pc2(file("v.pc2", pc2_bytes(1, 2, 3, data)));
  EXPECT_EQ(pc2.n_points(), 2);
  EXPECT_EQ(pc2.n_samples(), 2);
  EXPECT_EQ(pc2.read(1), (std::vector<float>{6, 7, 8, 9, 10, 11}));
  EXPECT_EQ(pc2.read(0), (std::vector<float>{0, 1, 2, 3, 4, 5}));
  EXPECT_THROW(pc2.read(2), IoError);
  EXPECT_THROW(pc2.read(-1), IoError);
}

TEST_F(SequenceFiles, BrokenPc2IsRefused) {
  const std::string good = pc2_bytes(1, 1, 1, {1, 2, 3});
  for (const std::string& bytes : {std::string(), good.substr(0, 31), "Q" + good.substr(1), pc2_bytes(2, 1, 1, {}),
                                   pc2_bytes(1, 0, 1, {}), pc2_bytes(1, -3, 1, {}), pc2_bytes(1, 1, -1, {})}) {
    EXPECT_NE(refusal([&] { Pc2File(file("v.pc2", bytes)); }).find("v.pc2"), std::string::npos);
  }
}

}  // namespace
}  // namespace livecap
