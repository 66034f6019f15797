// detections.jsonl: what the network saw, one JSON object per line and frame, without the mask.
//   {"frame":0,"person":true,"score":0.99,"keypoints":{"nose":[x_px,y_px,x_mm,y_mm,z_mm,confidence],...}}
// Keypoints are named as in livecap/detections.h; a frame without a person has none.
#pragma once

#include <filesystem>
#include <fstream>
#include <vector>

#include "base/detections.h"

namespace livecap::detect {

// The file is complete after every append.
class DetectionsWriter {
 public:
  // Replaces an existing file. Throws IoError.
  explicit DetectionsWriter(const std::filesystem::path& path);
  // Throws IoError when the disk is full and the like.
  void append(const Detections& detections);

 private:
  std::filesystem::path path_;
  std::ofstream out_;
};

// Throws IoError naming file, line and field: not JSON, missing or wrong fields, values that are not finite, frame
// numbers that do not rise, unknown keypoints. Keypoints that a line does not name have confidence 0.
std::vector<Detections> load_detections(const std::filesystem::path& path);

}  // namespace livecap::detect
