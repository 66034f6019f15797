// Short built-in sequences and captures of them, for tests of a whole run.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "base/scratch_folder.h"
#include "base/text.h"
#include "livecap/capture.h"
#include "support/test_device.h"
#include "synth/synth.h"

namespace livecap::test {

// A quarter of the paper's pixels, so that a run takes seconds.
inline SynthOptions small_sequence(int n_frames, int empty_frames) {
  SynthOptions options;
  options.width = 272;
  options.height = 480;
  options.n_frames = n_frames;
  options.empty_frames = empty_frames;
  return options;
}

// Both stages run on the first test device. What is learned is learned on the way.
inline CaptureOptions capture_of(const std::filesystem::path& sequence, const std::filesystem::path& out,
                                 const std::filesystem::path& model) {
  CaptureOptions options;
  options.video = sequence / "video.mp4";
  options.camera = sequence / "camera.json";
  options.background = sequence / "background.png";
  options.actor = sequence / "actor.glb";
  options.model = model;
  options.out = out;
  options.learn_frames = 0;
  options.cnn_device = options.solver_device = device_selectors().front();
  return options;
}

// Of who squats, written to scratch/sequence, by stage I alone. floor: camera.json has the true one.
inline CaptureOptions capture_of_squat(const ScratchFolder& scratch, int n_frames, int empty_frames, bool floor,
                                       const std::filesystem::path& model) {
  SynthOptions synth = small_sequence(n_frames, empty_frames);
  synth.motions = {"squat"};
  synth.floor = floor;
  write_sequence(synth, scratch / "sequence");
  CaptureOptions options = capture_of(scratch / "sequence", scratch / "capture", model);
  options.surface = false;
  return options;
}

// The columns index and status of frames.csv.
struct CsvRow {
  int64_t index = 0;
  std::string status;
};

inline std::vector<CsvRow> frame_rows(const std::filesystem::path& capture) {
  std::ifstream file(capture / "frames.csv");
  std::string line;
  std::getline(file, line);
  EXPECT_EQ(line.substr(0, 20), "index,pts_ms,status,") << line;
  std::vector<CsvRow> rows;
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    std::string index, pts_ms, status;
    std::getline(cells, index, ',');
    std::getline(cells, pts_ms, ',');
    std::getline(cells, status, ',');
    rows.push_back({std::stoll(index), status});
  }
  return rows;
}

// One row per input frame, in order.
inline void expect_every_frame_once(const std::vector<CsvRow>& rows, int64_t n_frames) {
  ASSERT_EQ(static_cast<int64_t>(rows.size()), n_frames);
  for (int64_t i = 0; i < n_frames; ++i) EXPECT_EQ(rows[i].index, i);
}

}  // namespace livecap::test
