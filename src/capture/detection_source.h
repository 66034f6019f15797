// Thread 2 of the pipeline: where detections come from, the network or a file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/detections.h"
#include "detect/pose_detector.h"
#include "livecap/camera.h"
#include "ocl/context.h"

namespace livecap {

struct DetectionOptions {
  std::string model;        // lite | full | heavy | path of a .tflite file
  std::string recorded;     // detections.jsonl instead of the network; empty: the network
  double missed_share = 0;  // of frames, chosen at random, in which the network is shown nothing: a test
  int draw = 0;             // of the network's detections: CaptureOptions::draw
};

class DetectionSource {
 public:
  // Throws IoError for a file that cannot be read, ConfigError for an unknown model.
  DetectionSource(const DetectionOptions& options, ocl::DeviceContext& device);

  void warm_up(const Camera& camera);

  // Forgets the person, and reads a file from its beginning.
  void start_over();

  // Whether a network is shown the frame.
  bool shows(int64_t frame_index) const { return network_ && !is_missed(frame_index); }

  // on_device: see BlazePose::set_picture; of frames that are shown only.
  Detections detect(const ImageRgb& image, const Camera& camera, int64_t frame_index, double time_s,
                    ocl::Buffer<uint8_t>* on_device);

 private:
  bool is_missed(int64_t frame_index) const;

  double missed_share_;
  std::optional<detect::PoseDetector> network_;
  std::vector<Detections> recorded_;
  size_t next_ = 0;
};

}  // namespace livecap
