// The tables of a capture folder: frames.csv, joints.csv and angles.csv (docs/formats.md). One row per input frame, on
// disk before the next one begins.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "actor/actor.h"
#include "livecap/capture.h"

namespace livecap {

class CsvWriter {
 public:
  // Writes the header row. Throws IoError when the file cannot be created.
  CsvWriter(const std::filesystem::path& path, const std::vector<std::string>& columns);

  // Throws LogicError for a wrong number of cells, IoError when the row cannot be written.
  void append(const std::vector<std::string>& cells);

 private:
  std::filesystem::path path_;
  std::ofstream file_;
  size_t n_columns_;
};

// A number as a cell: the shortest text that keeps `digits` significant digits; empty when it is not finite.
std::string csv_number(double value, int digits = 9);

// frames.csv: index, pts_ms, status, score, iou, energies, keypoint error, one column per stage, latency.
class FramesCsvWriter {
 public:
  // stage_names: the kStageCount names of CaptureStage.
  FramesCsvWriter(const std::filesystem::path& path, const std::vector<std::string>& stage_names);
  void append(const FrameReport& report, const std::string& status);

 private:
  CsvWriter csv_;
};

// joints.csv: position of every joint ("joint_left_elbow_x") and keypoint ("keypoint_nose_x") in metres, glTF frame.
class JointsCsvWriter {
 public:
  JointsCsvWriter(const std::filesystem::path& path, const Actor& actor);
  // pose: camera_from_rest pose of the frame; tracked 0 marks a held result.
  void append(int64_t index, double pts_ms, bool tracked, const Pose& pose);
  // A frame without any result: empty cells.
  void append_missing(int64_t index, double pts_ms);

 private:
  Skeleton skeleton_;
  std::array<KeypointAnchor, kKeypointCount> keypoints_;
  CsvWriter csv_;
};

// angles.csv: every joint angle by its name ("left_elbow_y"), degrees.
class AnglesCsvWriter {
 public:
  AnglesCsvWriter(const std::filesystem::path& path, const Skeleton& skeleton);
  // tracked 0 marks a held result.
  void append(int64_t index, double pts_ms, bool tracked, const Pose& pose);
  // A frame without any result: empty cells.
  void append_missing(int64_t index, double pts_ms);

 private:
  int n_angles_;
  CsvWriter csv_;
};

}  // namespace livecap
