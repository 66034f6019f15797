// Reading what a comparison needs from a capture folder and a truth folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace livecap {

struct FrameRow {
  int64_t index = 0;      // of the input frame
  std::string status;     // livecap/capture.h's track_status_name
  double pts_ms = 0;      // NaN when the file has no such column
  double latency_ms = 0;  // likewise
  bool tracked() const { return status == "ok" || status == "initialized"; }
};

// Joint positions over time, metres, glTF frame.
struct JointTrack {
  std::vector<std::string> names;
  // [n_frames] of [3*n_names]; empty where nobody is there. In a capture a joint that is not known has NaN for all
  // three.
  std::vector<std::vector<float>> frames;
  std::vector<FrameRow> rows;  // what joints.csv itself tells of its frames; empty: it has no column `index`
  bool empty() const { return names.empty(); }
};

// Where a name is among a track's; -1: nowhere.
int index_of(const std::vector<std::string>& names, const std::string& name);

// joints.json of a truth folder: {"names":[...],"frames":[[[x,y,z],...] or null,...]}. Throws IoError naming the field.
JointTrack read_joints_json(const std::filesystem::path& path);

// joints.csv of a capture folder: the joints and those keypoints that no joint has the name of. Its frames are tracked
// when a joint is known and the column `tracked`, where there is one, is not 0. Throws IoError naming the column or the
// line.
JointTrack read_joints_csv(const std::filesystem::path& path);

// Joint angles over time, degrees.
struct AngleTrack {
  std::vector<std::string> names;
  std::vector<std::vector<double>> frames;  // [n_frames] of [n_names]; empty where there is no result
  bool empty() const { return names.empty(); }
};

// angles.csv of a capture folder: the columns after `tracked`. Throws IoError naming the column or the line.
AngleTrack read_angles_csv(const std::filesystem::path& path);

// frames.csv of a capture folder.
std::vector<FrameRow> read_frames_csv(const std::filesystem::path& path);

}  // namespace livecap
