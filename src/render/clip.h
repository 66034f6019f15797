// The part of a capture that is rendered: which rows, where the person is, where the floor.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "eval/capture_folder.h"
#include "level/capture_floor.h"
#include "render/options.h"

namespace livecap::render {

struct Clip {
  CaptureFolder capture;
  std::vector<int64_t> rows{};  // of frames.csv, ascending
  // Looked for in views about the person only:
  Eigen::Vector3d place_mm = Eigen::Vector3d::Zero();  // the median of the root over the tracked rows, camera frame
  Floor floor{};

  bool tracked(int64_t row) const { return capture.rows[row].tracked(); }
  // Of all joints and keypoints, mm, camera frame; empty in a row that is not tracked.
  std::vector<Eigen::Vector3d> joints(int64_t row) const;
  // [3*n] mm, camera frame; empty in a row that is not tracked.
  std::vector<float> vertices(int64_t row);
};

// Throws IoError naming the file: no capture, nothing in it of what was asked for, files that do not fit together.
Clip open_clip(const RenderOptions& options);

}  // namespace livecap::render
