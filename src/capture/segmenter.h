// Threads 3 and 4 of the pipeline: which pixels are the person. In the first frames without one, in case that the
// network has just missed the person: which are not the background.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>

#include "capture/work_item.h"
#include "image/background_model.h"
#include "image/device_distance.h"
#include "image/foreground.h"
#include "image/frame_pool.h"
#include "ocl/context.h"

namespace livecap {

class Segmenter {
 public:
  // device, gate_device: the solver's, each with a queue of its own. gated: the network's mask takes part; without an
  // empty plate it always does. frames_under_way: so many frames may be on the device at a time.
  Segmenter(ocl::DeviceContext& device, ocl::DeviceContext& gate_device, const BackgroundModel& background,
            const Camera& camera, bool gated, int frames_under_way);

  // Launches every kernel once, on a person in the middle of a grey picture, then forgets it.
  void warm_up();

  // Nobody has been there yet.
  void start_over() { missed_frames_ = kNobodyYet; }

  // For the picture, before the frame is segmented. May be called by another thread.
  std::shared_ptr<DeviceFrame> take_frame() { return frames_.take(); }

  // In the order of frames: it counts those without anybody.
  void find_gate(WorkItem& item);

  // May run beside find_gate() of later frames. Against an empty plate nobody is where hardly anything differs from it,
  // whatever the network sees there.
  void segment(WorkItem& item);

 private:
  static constexpr int64_t kNobodyYet = std::numeric_limits<int32_t>::max();

  // The network's, where it takes part: of the picture, or of the crop.
  const PersonMask& network_mask(const WorkItem& item) const { return gated_ ? item.detections.mask : no_mask_; }
  const CropMask* crop_mask(const WorkItem& item) const {
    return gated_ && item.detections.crop_mask ? &*item.detections.crop_mask : nullptr;
  }

  ocl::DeviceContext& device_;
  int width_, height_;
  ForegroundSegmenter foreground_;
  DeviceDistanceField distance_;
  ocl::Buffer<float> sure_distance_;  // [w*h] px
  FramePool frames_;
  const PersonMask no_mask_;
  bool gated_;
  int64_t missed_frames_ = kNobodyYet;
};

}  // namespace livecap
