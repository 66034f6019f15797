// What a pose network saw in one frame, in terms no network owns: the 23 observation keypoints of LiveCap-32.
// This is the only thing that crosses from the network context to the solver context (with the person mask).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

namespace livecap {

// Observation keypoints: 19 body, then 4 face. Left and right are the subject's.
enum Keypoint : int {
  kHeadTop,
  kNeck,
  kPelvis,
  kLeftHip,
  kRightHip,
  kLeftShoulder,
  kRightShoulder,
  kLeftElbow,
  kRightElbow,
  kLeftWrist,
  kRightWrist,
  kLeftHand,
  kRightHand,
  kLeftKnee,
  kRightKnee,
  kLeftAnkle,
  kRightAnkle,
  kLeftToe,
  kRightToe,
  kLeftEye,
  kRightEye,
  kNose,
  kChin,
  kKeypointCount
};
inline constexpr int kBodyKeypointCount = 19;

// snake_case names, index = Keypoint.
extern const std::array<std::string_view, kKeypointCount> kKeypointNames;

struct KeypointDetection {
  float x_px = 0;  // undistorted image, pixel centres at integers
  float y_px = 0;
  float x_mm = 0;  // relative to the mid-hip, camera axes (x right, y down, z away), the network's own scale
  float y_mm = 0;
  float z_mm = 0;
  float confidence = 0;  // in [0,1]; 0 = the network does not know this keypoint
};

// 8-bit person probability, whole image size, row major. Empty when the network gives none.
struct PersonMask {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> probability;  // [width*height], 255 = person
  bool empty() const { return probability.empty(); }
};

struct CropMask;

struct Detections {
  int64_t frame_index = 0;
  bool person = false;  // score >= 0.5
  float score = 0;      // probability that the crop holds a person
  std::array<KeypointDetection, kKeypointCount> keypoints{};
  PersonMask mask;
  // Instead of `mask`, between threads of a capture: src/image/crop_mask.h.
  std::shared_ptr<const CropMask> crop_mask;
};

}  // namespace livecap
